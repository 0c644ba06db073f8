#pragma once
// Whom people with bodies see: those they follow, and those who come towards them.

#include "crowd_client/bodies/body_state.hpp"

namespace wade::crowd {

inline constexpr double furthest_look = 2.6;  // m; images beyond the joint of a periodic world stand as far away

// lambda of bodies.hpp as place k sees it now, at p.
[[nodiscard]] double share_followed(const Bodies& bodies, std::size_t k, const Vector2d& p);

// o of bodies.hpp as place k sees it now, at p.
[[nodiscard]] double share_opposed(const Bodies& bodies, std::size_t k, const Vector2d& p);

}  // namespace wade::crowd
