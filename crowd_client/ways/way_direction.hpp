#pragma once
// The direction in which a field of navigation.hpp falls.

#include <optional>

#include "crowd_client/ways/navigation.hpp"

namespace wade::crowd {

// The way from p, with the length that is left of it, m; nothing where none is in sight.
// p: in the world, or in the lap of a periodic one in which `rest` leads to the goal's image. rest: goal - p, m.
[[nodiscard]] std::optional<Vector2d> way_from(const Navigation& navigation, const WayField& field, const Vector2d& p,
                                               const Vector2d& rest);

}  // namespace wade::crowd
