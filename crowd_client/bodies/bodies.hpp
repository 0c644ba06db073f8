#pragma once
// People with bodies: discs that never overlap, and that get round one another.
//
// BioCrowds keeps points apart. Here each agent is a disc of radius r. It claims markers ahead of itself, discounts those
// that somebody else is about to reach, and of the step that it wishes for it takes what its limits leave:
//
//   site       q = p + Rot(-phi min(1, 3 kappa)) tau v, at most 1 m ahead; Rot(-angle) turns to the right
//   claims     a marker a belongs to the agent whose q is nearest, within R
//   discount   a is contested if |a - (p_j + v_j d / v0)| < D for another j whose site reaches the marker's cell,
//              d = |a - p|; its preference f (Eq. 3) is then multiplied by 1 - delta
//   goal       turned to the right by alpha b before Eq. 3; to the other side after each 5 s with b > 0.9, as in a corner
//   wish       w = dt v_B (1 - lambda exp(-gamma A)), v_B of Eq. 4
//   limits     u.n <= g / 2 for each neighbour, g = max(0, d_ij - 2 r - slack), n = (p_j - p) / d_ij
//              u.n <= g for each obstacle and each edge of the world, the whole gap
//   step       u: w slid along the limit that it breaks most, twice, then shortened until it keeps all; p += u
//
//   p, v    place, and displacement of the last step / dt     v0      desired speed
//   kappa   contested share of the own markers, over 0.2 s    A       ground that the own markers stand for
//   b       share of the time with |u| < v0 dt / 2, over T_b  lambda  how much those within 1.5 m walk the same way: mean
//                                                                     cosine with their headings, >= 0, over 1 s
//
// No overlap, whatever is wished and whatever pushes: let d >= 2 r be the distance of i and j before a step. If g > 0, it
// is at least d - u_i.n + u_j.n >= d - g / 2 - g / 2 = 2 r + slack after it; if g = 0, at least d. A disc whose centre
// stays on its side of the plane r before a convex obstacle's nearest point, normal to the way there, keeps off all of it.
// u = 0 keeps all limits, and all reads are of the state before the step.
//
// `fast` has lambda = 0. `human` follows: speed falls with the ground that is free only among people who walk the same
// way, as in the corridors in which the speed over density is measured; who crosses gets through as with `fast`.
// The values are those that did best in trials with crossing goals; gamma is fitted to Weidmann's curve from 0.5 to 3
// people/m2 in a corridor (1.9, near the 1.913 of his formula, leaves speeds 0.10 m/s too high at 2).

#include <cstdint>
#include <span>
#include <vector>

#include "crowd_client/agents.hpp"
#include "crowd_client/bodies/body_cells.hpp"
#include "crowd_client/markers/biocrowds.hpp"
#include "crowd_client/ways/obstacles.hpp"

namespace wade::crowd {

// The numbers of the rule.
struct BodyStyle {
    double lead_time = 0.4;          // tau, s
    double side_turn = 0.2;          // phi, rad
    double detour_turn = 1.5;        // alpha, rad
    double discount = 0.9;           // delta; at 1 crowds jam
    double contest_distance = 0.45;  // D, m
    double patience = 0.5;           // T_b, s
    double spacing_rate = 0;         // gamma, 1/m2; 0: nobody follows
};
[[nodiscard]] BodyStyle body_style(BodyRule rule);

struct Bodies {
    BodyRule rule = BodyRule::none;
    BodyStyle style;
    double radius = 0.25;  // r, m

    // Working memory of a step, by place in the list of the active.
    std::vector<Vector2d> site, velocity, turned_goal;
    std::vector<double> desired_speed, discount;
    std::vector<double> followed;  // mean cosine with the headings of those near; empty in steps without a look
    BodyCells cells;
    std::vector<Vector2d> step;  // u, m
};

constexpr double body_slack = 1e-4;  // m, kept between bodies so that rounding never makes them overlap

// Fills `walkers` with what bodies need to claim markers. goal_offsets and positions by place in `active`.
void prepare_bodies(Bodies& bodies, Walkers& walkers, const Agents& agents, std::span<const std::uint32_t> active,
                    std::span<const Vector2d> positions, std::span<const Vector2d> goal_offsets, const World& world,
                    double perception_radius, bool look_whom_to_follow, int threads);

// Whether the crowd looks at whom it follows in a step: every 0.2 s, or in each step if those are longer.
[[nodiscard]] bool looks_whom_to_follow(std::uint64_t step, double dt);

// The walking velocity that agent `id`, at place k, wishes for, m/s; updates its kappa and lambda.
[[nodiscard]] Vector2d wished_velocity(const Bodies& bodies, Agents& agents, std::uint32_t id, std::size_t k,
                                       const Motion& motion, double marker_area, SpeedRule rule, double dt);

// Of the wishes, m, the steps that overlap nobody, into bodies.step. ends: along x, for each, by ends_for().
void limit_steps(Bodies& bodies, const Walls& walls, std::span<const Vector2d> positions,
                 std::span<const Vector2d> wishes, std::span<const Interval> ends, int threads);

// Updates b of an agent after its step u, m.
void note_blocked(const Bodies& bodies, Agents& agents, std::uint32_t id, const Vector2d& u, double dt);

// Moves people apart who start closer than two radii, or closer to an obstacle than one. Throws ConfigurationError if there
// is no room.
void make_room_for_bodies(Agents& agents, const Walls& walls, double radius);

}  // namespace wade::crowd
