#pragma once
// The responses by their names.

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "crowd_client/responses/response.hpp"

namespace wade::crowd {

struct RegisteredResponse {
    std::string_view name;  // its word in scenes, of Words<ResponseKind> (configs/scene/choices.hpp)
    std::unique_ptr<Response> (*make)(const Scene&);
};

template <typename Kind>
[[nodiscard]] std::unique_ptr<Response> new_response(const Scene& scene) {
    return std::make_unique<Kind>(scene);
}

// Returns all responses.
[[nodiscard]] std::span<const RegisteredResponse> responses();

// Returns the response of this name, set up for a scene. Throws ConfigurationError for a name that is not in the list.
[[nodiscard]] std::unique_ptr<Response> make_response(std::string_view name, const Scene& scene,
                                                      std::span<const RegisteredResponse> list = responses());

}  // namespace wade::crowd
