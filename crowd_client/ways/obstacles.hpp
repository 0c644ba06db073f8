#pragma once
// Where agents may be: the world's rectangle without the obstacles; and how a step is bent to stay there.
//
// Along x the world ends in one of these ways:
//
//   flow of the channel                  at x = 0                    at x = length
//   emitter, recirculating, periodic     the fall, where who is      a wall
//                                        carried over it is lost
//   closed                               a wall                      a wall
//   any, in a world with periodic ends   x = length                  x = 0
//
// The two ends of a closed channel are walls wherever it lies in the world, for whoever is in it and has its goal between them;
// who wants to leave it passes, as people pass the banks.

#include <optional>

#include "configs/scene/interval.hpp"
#include "configs/scene/scene.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/equations.hpp"
#include "crowd_client/markers/placed_boxes.hpp"
#include "crowd_client/markers/placed_houses.hpp"

namespace wade::crowd {

// Obstacles as agents meet them, each face moved outwards by `skin` so that boxes that touch leave no gap. Those of a
// periodic world stand there three times, a world's length apart. Those of a scene with a site are among its houses.
struct Walls {
    static constexpr double skin = 1e-6;  // m

    // The ground of a closed channel.
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

// The ends along x that hold for a step of somebody at p, m; infinite where there is none.
//   goal_x        of its goal, m
//   carried_down  whether the water pushes it towards -x
[[nodiscard]] Interval ends_for(const Walls& walls, const Vector2d& p, double goal_x, bool carried_down);

// The nearest place outside all boxes and houses for a point that is at most `skin` inside one; nothing if it lies deeper.
[[nodiscard]] std::optional<Vector2d> place_outside(const Walls& walls, const Vector2d& p);

// The walking velocity that stays in the world within dt: the component that would leave it is shortened. A periodic
// world has no ends along x.
[[nodiscard]] Vector2d keep_in_world(const World& world, const Vector2d& p, const Vector2d& walking, double dt);

// Moves a point along `displacement` and slides along the faces it meets; it never enters a box or a house, however far it
// moves.
// The ends along x and the world's edges along z stop it, too.
//   p             a place outside all boxes, in the world
//   displacement  m
[[nodiscard]] Vector2d slide(const Walls& walls, const Vector2d& p, const Vector2d& displacement, const Interval& ends);

// The same, and the place, where there are houses and no boxes.
[[nodiscard]] Vector2d slide_along_houses(const Walls& walls, const Vector2d& p, const Vector2d& displacement,
                                          const Interval& ends);
[[nodiscard]] std::optional<Vector2d> place_before_houses(const PlacedHouses& houses, const Vector2d& p);

}  // namespace wade::crowd
