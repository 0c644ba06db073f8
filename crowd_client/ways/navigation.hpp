#pragma once
// Ways round obstacles and crowds: fields of the travel time to each goal, and the direction in which they fall.
//
// Eq. 3 looks at the direction of the goal alone. With the rule `travel_time` it is given, instead of goal - X,
//
//   goal - X                   where the goal is in sight; with crowding only within the disc from which the field starts
//   -L grad L / |grad L|       in a cell of the field that no obstacle reaches, L bilinear between its nodes
//   L (n - X) / |n - X|        in other cells and where grad L = 0: the node n, of those in sight within the reach and at
//                              least a cell away, with the least L = L(n) + |n - X|; no such way leads into an obstacle
//
//   L        length of way that takes as long as the way does, v T, v the desired speed: from travel_time.hpp with
//            s = v / f, so that people of any speed share a field. Eq. 3 does not depend on it.
//   f        v W(c rho), W(rho) = 1 - exp(-1.913 (1 / rho - 1 / 5.4)), at least 0.1: Weidmann, Transporttechnik der
//            Fussgaenger, IVT ETH Zuerich 90 (1993), Eq. for the speed over the density in people per m2, over free speed
//   c        crowding
//   rho      people per m2, each one spread as hat(x) hat(z), hat(x) = (1 - |x| / l) / l, l = 2 m or a cell if that is more
//
// Ways are looked for every 0.1 s, as bodies decide, and kept in between.
//
// Obstacles count with the clearance round them along each axis: nobody's body fits nearer. Where an agent is nearer all the
// same (at a corner, or a point without a body), it looks for the nodes from there.
//
// With the rule `auto` a field is solved once somebody, at the start or in a look once a second, does not see its goal or a
// place in which it would have arrived; until then all go straight, and where no obstacle is in anybody's way nothing is made
// at all. People who are pushed behind a house so find round it a second later.
//
// A periodic world is laid out five times along x, the goals in the lap in the middle, so that ways lead over the joint. A
// goal that is more laps away stands for its image on the same side that is half a lap to one and a half away.

#include <cstdint>
#include <span>
#include <string>

#include "configs/scene/interval.hpp"
#include "crowd_client/agents.hpp"
#include "crowd_client/ways/obstacles.hpp"
#include "crowd_client/ways/way_fields.hpp"

namespace wade::crowd {

// The distance to obstacles that the slimmest way of a person needs, m: half the width of the narrowest gap that it fits
// through.
[[nodiscard]] double least_clearance(const Scene& scene);

// Fields for the goals of all agents, with `auto` of those who do not see theirs. With the rule `straight`, and with nothing to
// get round, all is left empty and has no cost. `travel_time` throws ConfigurationError for an agent without a way to its goal,
// also in smaller cells, and for more cells than memory should hold; with `auto` such an agent goes straight.
[[nodiscard]] Navigation make_navigation(const Scene& scene, const Agents& agents);

// Whom no way leads to the goal at the start, as a sentence for the user, or nothing; also where the navigation is `straight`.
[[nodiscard]] std::string people_without_way(const Navigation& navigation, const Scene& scene, const Agents& agents);

// Whether anybody is led by a field, or may come to be.
[[nodiscard]] inline bool finds_ways(const Navigation& navigation) {
    return !navigation.fields.empty();
}

// Whether in this step fields are solved again, or looked for that have become needed.
[[nodiscard]] inline bool is_due(const Navigation& navigation, std::uint64_t step) {
    return navigation.steps_between != 0 && step % navigation.steps_between == 0;
}

// Solves the fields again, or those that have become needed, in a step in which that is due. positions and goal_offsets, m: of the
// active agents.
void update_navigation(Navigation& navigation, const Scene& scene, std::span<const std::uint32_t> active,
                       std::span<const Vector2d> positions, std::span<const Vector2d> goal_offsets, int threads);

// Turns goal_offsets, m, of the active agents into the way that they should take. An agent that sees no way goes straight.
// decision: its number, from 0 on.
void steer(Navigation& navigation, std::span<const std::uint32_t> active, std::span<const Vector2d> positions,
           std::span<Vector2d> goal_offsets, std::uint64_t decision, int threads);

// Computes the slowness v / f of all nodes from the density of people at these positions, m.
void find_slowness(Navigation& navigation, std::span<const Vector2d> positions);

// Closes what stands on a grid that is laid out, and finds the reach and the radius round goals.
void finish_grid(Navigation& navigation, const Scene& scene);

// Exact times on the nodes round the goal that it sees.
void start_at_goal(const Navigation& navigation, WayField& field);

// The ways from everywhere in a rectangle to one goal in it, round what reaches into it: one field, of no agent.
[[nodiscard]] Navigation ways_within(const Scene& scene, const Walls& walls, const Interval& x, const Interval& z,
                                     const Vector2d& goal);

}  // namespace wade::crowd
