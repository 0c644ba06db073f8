#pragma once
// Neighbour perception of agents with bodies: neighbours that an agent follows, and oncoming neighbours.

#include <vector>

#include "crowd_client/bodies/body_cells.hpp"

namespace wade::crowd {

inline constexpr double furthest_look = 2.6;  // m; also the width of the strip of periodic images

// Directions of the neighbours, in the order of the entries of BodyCells.
struct Looks {
    std::vector<float> heading_x, heading_z, way_x, way_z, bearing_x, bearing_z;
};

// Store unit vectors, given by index in the list of people, in the order of the cells: last motion; route and straight
// to the goal.
void sort_headings(Looks& looks, const BodyCells& cells, const std::vector<Vector2d>& heading);
void sort_routes(Looks& looks, const BodyCells& cells, const std::vector<Vector2d>& way,
                 const std::vector<Vector2d>& bearing);

// Computes the current lambda of bodies.hpp, before its running mean, for an agent at p.
[[nodiscard]] double share_followed(const Looks& looks, const BodyCells& cells, const Vector2d& p,
                                    const Vector2d& heading);

// Computes the current o of bodies.hpp, before its running mean, for an agent at p.
[[nodiscard]] double share_opposed(const Looks& looks, const BodyCells& cells, const Vector2d& p, const Vector2d& way,
                                   const Vector2d& bearing);

}  // namespace wade::crowd
