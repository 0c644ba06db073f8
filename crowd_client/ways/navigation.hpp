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
// Obstacles count with the clearance round them along each axis: nobody's body fits nearer. Where an agent is nearer all the
// same (at a corner, or a point without a body), it looks for the nodes from there.
//
// A periodic world is laid out five times along x, the goals in the lap in the middle, so that ways lead over the joint. A
// goal that is more laps away stands for its image on the same side that is half a lap to one and a half away.

#include <cstdint>
#include <span>

#include "crowd_client/agents.hpp"
#include "crowd_client/ways/way_fields.hpp"

namespace wade::crowd {

// Fields for the goals of all agents. Throws ConfigurationError for an agent without a way to its goal, and for more cells
// than memory should hold. With the rule `straight`, and with nothing to get round, all is left empty and has no cost.
[[nodiscard]] Navigation make_navigation(const Scene& scene, const Agents& agents);

[[nodiscard]] inline bool finds_ways(const Navigation& navigation) {
    return !navigation.fields.empty();
}

// Solves the fields again if this step is one for it. positions: of the active agents.
void update_navigation(Navigation& navigation, std::span<const Vector2d> positions, std::uint64_t step, int threads);

// Turns goal_offsets, m, of the active agents into the way that they should take. An agent that sees no way goes straight.
void steer(const Navigation& navigation, std::span<const std::uint32_t> active, std::span<const Vector2d> positions,
           std::span<Vector2d> goal_offsets, int threads);

}  // namespace wade::crowd
