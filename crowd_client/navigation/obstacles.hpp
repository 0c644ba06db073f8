#pragma once
// Walkable area: the world's rectangle without the obstacles. Steps slide along its edges.
//
// Boundary conditions along x:
//
//   flow of the channel                  at x = 0                    at x = length
//   emitter, recirculating, periodic     the outfall, where agents   a wall
//                                        swept over it are lost
//   closed                               a wall                      a wall
//   any, in a world with periodic ends   x = length                  x = 0
//
// The two ends of a closed channel are walls, wherever it lies in the world, for agents in it with their goal between
// the ends. An agent with its goal outside passes them, as agents pass the banks.

#include <optional>

#include "configs/scene/interval.hpp"
#include "configs/scene/scene.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/equations.hpp"
#include "crowd_client/markers/placed_boxes.hpp"
#include "crowd_client/markers/placed_houses.hpp"

namespace wade::crowd {

// Obstacles as walls for agents, each face moved outwards by `skin` so that touching boxes leave no gap. A periodic
// world has three copies of them, a world's length apart. With a site the obstacles are among its houses.
struct Walls {
    static constexpr double skin = 1e-6;  // m

    // The ground plan of a closed channel.
    struct Tank {
        Interval x, z;
    };

    World world;
    PlacedBoxes boxes;
    bool has_fall = true;
    std::optional<Tank> tank = {};
    PlacedHouses houses = {};

    [[nodiscard]] bool has_any() const { return !boxes.all.empty() || !houses.empty(); }
};

[[nodiscard]] Walls make_walls(const Scene& scene);

// Returns the bounds along x for a step of an agent at p, m; infinite where there is none.
//   goal_x        x of its goal, m
//   carried_down  whether the water pushes it towards -x
[[nodiscard]] Interval ends_for(const Walls& walls, const Vector2d& p, double goal_x, bool carried_down);

// Returns the nearest position outside all boxes and houses for a point at most `skin` inside one; nothing if it lies
// deeper.
[[nodiscard]] std::optional<Vector2d> place_outside(const Walls& walls, const Vector2d& p);

// Returns the walking velocity that stays in the world within dt, with the outward component shortened. A periodic
// world has no ends along x.
[[nodiscard]] Vector2d keep_in_world(const World& world, const Vector2d& p, const Vector2d& walking, double dt);

// Moves a point along `displacement` and slides along the faces that it meets. The point never enters a box or a house,
// for displacements of any length. It also stops at the ends along x and at the world's edges along z.
//   p             a position outside all boxes, in the world
//   displacement  m
[[nodiscard]] Vector2d slide(const Walls& walls, const Vector2d& p, const Vector2d& displacement, const Interval& ends);

// slide() and place_outside() for scenes with houses and without boxes.
[[nodiscard]] Vector2d slide_along_houses(const Walls& walls, const Vector2d& p, const Vector2d& displacement,
                                          const Interval& ends);
[[nodiscard]] std::optional<Vector2d> place_before_houses(const PlacedHouses& houses, const Vector2d& p);

}  // namespace wade::crowd
