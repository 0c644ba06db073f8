#pragma once
// Where agents may be: the world's rectangle without the obstacles; and how a step is bent to stay there.

#include <optional>
#include <vector>

#include "configs/scene/scene.hpp"
#include "crowd_client/equations.hpp"

namespace wade::crowd {

// Obstacles as agents meet them, each face moved outwards by `skin` so that boxes that touch leave no gap. Those of a
// periodic world stand there three times, a world's length apart.
struct Walls {
    static constexpr double skin = 1e-6;  // m

    World world;
    std::vector<Obstacle> boxes;
};

[[nodiscard]] Walls make_walls(const Scene& scene);

// The nearest place outside all boxes for a point that is at most `skin` inside one; nothing if it lies deeper.
[[nodiscard]] std::optional<Vector2d> place_outside(const Walls& walls, const Vector2d& p);

// The walking velocity that stays in the world within dt: the component that would leave it is shortened. A periodic
// world has no ends along x.
[[nodiscard]] Vector2d keep_in_world(const World& world, const Vector2d& p, const Vector2d& walking, double dt);

// Moves a point along `displacement` and slides along the faces it meets; it never enters a box, however far it moves.
// The world's edges stop it too, except the fall at x = 0 where `may_fall` is true, and except the ends of a periodic
// world: there the result may lie beyond them.
//   p             a place outside all boxes, in the world
//   displacement  m
[[nodiscard]] Vector2d slide(const Walls& walls, const Vector2d& p, const Vector2d& displacement, bool may_fall);

}  // namespace wade::crowd
