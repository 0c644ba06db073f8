#pragma once
// The measured response: people answer the water by their bodies, with drag, buoyancy and what their feet hold.

#include <memory>

#include "crowd_client/responses/response.hpp"

namespace wade::crowd {

// Each who answers by its body takes a step of people/person.hpp, by the state that people/states.hpp has found for it; others,
// of a given tau, answer as the response of the paper.
[[nodiscard]] std::unique_ptr<Response> make_measured_response(const Scene& scene);

}  // namespace wade::crowd
