#pragma once
// The measured response: people respond to the water by their bodies, with drag, buoyancy and friction at their feet.

#include <memory>

#include "crowd_client/responses/response.hpp"

namespace wade::crowd {

// An agent that responds by its body takes a step of people/person.hpp, in its state of people/states.hpp. An agent of
// a given tau responds as in the paper.
[[nodiscard]] std::unique_ptr<Response> make_measured_response(const Scene& scene);

}  // namespace wade::crowd
