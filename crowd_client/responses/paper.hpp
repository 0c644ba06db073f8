#pragma once
// The response of the paper: people are moved by the momentum of the particles that touch them, Eq. 6-9.

#include <memory>

#include "crowd_client/responses/response.hpp"

namespace wade::crowd {

// By the scene's /coupling/rule:
//   per_frame    Eq. 9 once a step
//   continuous   Eq. 9 in continuous time, see relaxed_velocity(); with /coupling/sampling_rate_hz above the step rate the
//                water is sampled several times a step, see sampled_coupling.hpp
[[nodiscard]] std::unique_ptr<Response> make_paper_response(const Scene& scene);

}  // namespace wade::crowd
