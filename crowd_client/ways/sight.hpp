#pragma once
// Whether obstacles or houses stand between two places.

#include <cstdint>
#include <span>
#include <vector>

#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/scene.hpp"
#include "crowd_client/equations.hpp"
#include "crowd_client/markers/placed_boxes.hpp"
#include "crowd_client/markers/placed_houses.hpp"

namespace wade::crowd {

// Obstacles of the whole way, and the distance to them that a way should keep along each axis, to houses in any direction.
struct Sight {
    PlacedBoxes boxes;
    double clearance = 0;  // m, >= 0
    PlacedHouses houses = {};
};

// The box with each face moved outwards by `margin`, m.
[[nodiscard]] Obstacle grown(const Obstacle& box, double margin);

// Whether the way from p to q passes through the inside of a box; along a face is not inside.
[[nodiscard]] bool crosses(const Obstacle& box, const Vector2d& p, const Vector2d& q);

// The distance to all boxes that ways from p can keep, m: the clearance, or less where p itself is nearer to one, as a
// body's centre may be at a corner. One distance for all, so that boxes side by side stay one.
[[nodiscard]] double margin_at(const Obstacle& box, double clearance, const Vector2d& p);

// margin_at() of all boxes.
[[nodiscard]] double margin_from(const Sight& sight, const Vector2d& p);

// Whether the straight way from p to q keeps a margin of at most the clearance, m, to all boxes.
[[nodiscard]] bool sees_with(const Sight& sight, double margin, const Vector2d& p, const Vector2d& q);

// Whether the straight way from p to q keeps the distance that both ends have, at most the clearance, to all boxes.
[[nodiscard]] bool in_sight(const Sight& sight, const Vector2d& p, const Vector2d& q);

// What is known for all places of a rectangle at once about a goal; of boxes alone.
enum class View : std::uint8_t { unknown, in_sight, hidden };

// in_sight if the goal is in sight of each place of the rectangle, hidden if of none; unknown may be either. What can hide the
// goal from an unknown place is put behind `hiding`, if it is given: places in sight.boxes.all, ascending.
[[nodiscard]] View view_of(const Sight& sight, const Interval& x, const Interval& z, const Vector2d& goal,
                           std::vector<std::uint32_t>* hiding = nullptr);

// in_sight() where nothing but these boxes can stand in the way.
[[nodiscard]] bool in_sight(const Sight& sight, const Vector2d& p, const Vector2d& q,
                            std::span<const std::uint32_t> hiding);

}  // namespace wade::crowd
