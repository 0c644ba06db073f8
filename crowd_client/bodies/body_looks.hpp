#pragma once
// Whom people with bodies see: those they follow, and those who come towards them.

#include <vector>

#include "crowd_client/bodies/body_cells.hpp"

namespace wade::crowd {

inline constexpr double furthest_look = 2.6;  // m; images beyond the joint of a periodic world stand as far away

// What people see of one another, in the order of BodyCells.
struct Looks {
    std::vector<float> heading_x, heading_z, way_x, way_z, bearing_x, bearing_z;
};

// Unit vectors by place in the list of people: of the last motion, and of the way and to the goal.
void sort_headings(Looks& looks, const BodyCells& cells, const std::vector<Vector2d>& heading);
void sort_ways(Looks& looks, const BodyCells& cells, const std::vector<Vector2d>& way,
               const std::vector<Vector2d>& bearing);

// lambda of bodies.hpp as somebody at p sees it now.
[[nodiscard]] double share_followed(const Looks& looks, const BodyCells& cells, const Vector2d& p,
                                    const Vector2d& heading);

// o of bodies.hpp as somebody at p sees it now.
[[nodiscard]] double share_opposed(const Looks& looks, const BodyCells& cells, const Vector2d& p, const Vector2d& way,
                                   const Vector2d& bearing);

}  // namespace wade::crowd
