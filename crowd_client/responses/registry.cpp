#include "crowd_client/responses/registry.hpp"

#include <algorithm>
#include <array>

#include "configs/errors/exit_code.hpp"
#include "crowd_client/responses/measured.hpp"
#include "crowd_client/responses/paper.hpp"

namespace wade::crowd {
namespace {

constexpr std::array registered{
    RegisteredResponse{"paper", make_paper_response},
    RegisteredResponse{"measured", make_measured_response},
};

}  // namespace

std::span<const RegisteredResponse> responses() {
    return registered;
}

std::unique_ptr<Response> make_response(std::string_view name, const Scene& scene,
                                        std::span<const RegisteredResponse> list) {
    const auto found = std::find_if(list.begin(), list.end(), [&](const auto& entry) { return entry.name == name; });
    if (found != list.end()) return found->make(scene);
    std::string known;
    for (const RegisteredResponse& entry : list)
        known += (known.empty() ? "\"" : ", \"") + std::string(entry.name) + '"';
    throw ConfigurationError("/crowd/response: \"" + std::string(name) + "\" is not allowed; allowed: " + known + ".");
}

}  // namespace wade::crowd
