#pragma once
// Routes around obstacles and crowds: travel-time fields for each goal, and their direction of steepest descent.
//
// Eq. 3 uses only the direction of the goal. With the rules `travel_time` and `auto` it gets one of these offsets:
//
//   goal - X                   where the goal is visible; with crowding only within the disc where the field starts
//   -L grad L / |grad L|       in a cell of the field that no obstacle reaches, L bilinear between its nodes
//   L (n - X) / |n - X|        in other cells and where grad L = 0. Node n is visible, within the reach, at least a
//                              cell away, and has the smallest L = L(n) + |n - X|. The segment to n meets no obstacle.
//
//   L        equivalent route length v T: the distance at the desired speed v in the travel time T of travel_time.hpp
//            with s = v / f. People of any speed share a field, and Eq. 3 does not depend on L.
//   f        v W(c rho), W(rho) = 1 - exp(-1.913 (1 / rho - 1 / 5.4)), at least 0.1: Weidmann, Transporttechnik der
//            Fussgaenger, IVT ETH Zuerich 90 (1993), Eq. for the speed over the density in people per m2, over free
//            speed
//   c        crowding
//   rho      people per m2, each one spread as hat(x) hat(z), hat(x) = (1 - |x| / l) / l, l = 2 m or a cell if that is
//            more
//
// Routes are updated every 0.1 s, like the decisions of bodies, and kept in between.
//
// Obstacles are enlarged by the clearance along each axis, because the centre of a body comes no nearer. An agent may
// still be nearer, at a corner or as a point without a body. It then searches for nodes from its position.
//
// With the rule `auto` a field is solved once an agent sees neither its goal nor the nearest position of arrival. This
// is tested at the start and once a second. Until then agents walk straight, and no grid is laid out. An agent that is
// pushed behind a house therefore finds a route a second later.
//
// The grid of a periodic world covers five periods along x, with the goals in the middle one, so that routes cross the
// periodic boundary. A goal more than 1.5 periods away is replaced by its image on the same side, 0.5 to 1.5 periods
// away.

#include <cstdint>
#include <span>
#include <string>

#include "configs/scene/interval.hpp"
#include "crowd_client/agents.hpp"
#include "crowd_client/navigation/obstacles.hpp"
#include "crowd_client/navigation/travel_time_fields.hpp"

namespace wade::crowd {

// Returns the smallest distance to obstacles that a route of a person needs, m: half the width of the narrowest gap
// that the person fits through.
[[nodiscard]] double least_clearance(const Scene& scene);

// Returns fields for the goals of all agents; with `auto` only for goals hidden from their agents. Returns an empty
// navigation, at no cost, for the rule `straight`, and for scenes with neither obstacles nor crowding. Throws
// ConfigurationError with `travel_time` for an agent without a route to its goal, also in smaller cells, and for too
// many cells for the memory. With `auto` an agent without a route walks straight.
[[nodiscard]] Navigation make_navigation(const Scene& scene, const Agents& agents);

// Returns a sentence for the user about agents without a route to their goal at the start, or an empty text; also with
// the rule `straight`.
[[nodiscard]] std::string people_without_route(const Navigation& navigation, const Scene& scene, const Agents& agents);

// Returns whether a field leads an agent, or may do so later.
[[nodiscard]] inline bool finds_routes(const Navigation& navigation) {
    return !navigation.fields.empty();
}

// Returns whether fields are due in this step: to be solved again, or to be checked for need.
[[nodiscard]] inline bool is_due(const Navigation& navigation, std::uint64_t step) {
    return navigation.steps_between != 0 && step % navigation.steps_between == 0;
}

// Solves the fields again, or the newly needed ones, in a step that is_due(). positions, goal_offsets: of the active
// agents, m.
void update_navigation(Navigation& navigation, const Scene& scene, std::span<const std::uint32_t> active,
                       std::span<const Vector2d> positions, std::span<const Vector2d> goal_offsets, int threads);

// Turns goal_offsets, m, of the active agents into offsets along their routes. An agent without a route walks straight.
// decision: its number, from 0 on.
void steer(Navigation& navigation, std::span<const std::uint32_t> active, std::span<const Vector2d> positions,
           std::span<Vector2d> goal_offsets, std::uint64_t decision, int threads);

// Computes the slowness v / f of all nodes from the density of people at these positions, m.
void find_slowness(Navigation& navigation, std::span<const Vector2d> positions);

// Closes nodes, edges and cells in obstacles on a grid that is laid out; sets the reach and the start radius of goals.
void finish_grid(Navigation& navigation, const Scene& scene);

// Adds exact start times for nodes around the goal that are visible from it.
void start_at_goal(const Navigation& navigation, TravelTimeField& field);

// Returns routes from all positions of a rectangle to one goal in it, around obstacles that reach into it: one field,
// and no agent.
[[nodiscard]] Navigation ways_within(const Scene& scene, const Walls& walls, const Interval& x, const Interval& z,
                                     const Vector2d& goal);

}  // namespace wade::crowd
