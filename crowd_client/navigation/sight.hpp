#pragma once
// Visibility between two positions, past obstacles and houses.

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

// Obstacles of the whole route, and its clearance: to boxes along each axis, to houses in any direction.
struct Sight {
    PlacedBoxes boxes;
    double clearance = 0;  // m, >= 0
    PlacedHouses houses = {};
};

// Returns the box with each face moved outwards by `margin`, m.
[[nodiscard]] Obstacle grown(const Obstacle& box, double margin);

// Returns whether the segment from p to q passes through the inside of a box; along a face is not inside.
[[nodiscard]] bool crosses(const Obstacle& box, const Vector2d& p, const Vector2d& q);

// Returns the margin to all boxes that segments from p can keep, m: the clearance, or less if p itself is nearer to the
// box, as a body's centre may be at a corner. One margin holds for all boxes, so that adjacent boxes stay one.
[[nodiscard]] double margin_at(const Obstacle& box, double clearance, const Vector2d& p);

// Returns the smallest margin at p over all boxes and houses, m.
[[nodiscard]] double margin_from(const Sight& sight, const Vector2d& p);

// Returns whether the segment from p to q keeps a margin of at most the clearance, m, to all boxes and houses.
[[nodiscard]] bool sees_with(const Sight& sight, double margin, const Vector2d& p, const Vector2d& q);

// Returns whether the segment from p to q keeps the smaller margin of its two ends to all boxes and houses.
[[nodiscard]] bool in_sight(const Sight& sight, const Vector2d& p, const Vector2d& q);

// Visibility of a goal from all positions of a rectangle at once; considers boxes alone.
enum class View : std::uint8_t { unknown, in_sight, hidden };

// Returns in_sight if the goal is visible from each position of the rectangle, hidden if from none; unknown may be
// either. Appends to `hiding`, if given, the boxes that can hide the goal if the result is unknown: indices of
// sight.boxes.all, ascending.
[[nodiscard]] View view_of(const Sight& sight, const Interval& x, const Interval& z, const Vector2d& goal,
                           std::vector<std::uint32_t>* hiding = nullptr);

// in_sight() for a segment that only these boxes can block.
[[nodiscard]] bool in_sight(const Sight& sight, const Vector2d& p, const Vector2d& q,
                            std::span<const std::uint32_t> hiding);

}  // namespace wade::crowd
