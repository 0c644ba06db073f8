#pragma once
// People with bodies: discs that never overlap, and that get round one another.
//
// BioCrowds keeps points apart. Here each agent is a disc of radius r. It claims markers ahead of itself, discounts those
// that somebody else is about to reach, and of the step that it wishes for it takes what its limits leave:
//
//   site       q = p + Rot_right(phi min(1, 3 kappa)) s,  s = tau v  or  s = l v / (|v| + 0.15 m/s)
//   claims     a marker a belongs to the agent whose q is nearest, within R
//   discount   a is contested if |a - (p_j + v_j d / v0)| < D for another agent j near it, d = |a - p|; then f (1 - delta)
//   wish       w = dt s m / |m|, s = min(pi |m| v0, v0) (1 - lambda exp(-gamma max(0, A - A0)))
//   limits     u.n <= g / 2 for each neighbour, g = max(0, d - 2 r - slack), n = (p_j - p) / d
//              u.n <= g for each wall, the whole gap
//   step       u: w slid along the limit that it breaks most, twice, then shortened until it keeps all
//
//   p, v  place and displacement of the last step / dt        m      motion vector, Eq. 1, of the goal turned right by alpha b
//   kappa contested share of the own markers, smoothed        b      how much of the time the way is blocked, smoothed
//   v0    desired speed                                       A      ground that the own markers stand for
//   lambda share of those near who walk the same way, smoothed
//
// No overlap, whatever the wishes are: let d >= 2 r be the distance of i and j before a step. If g > 0, their distance
// along n is at least d - u_i.n + u_j.n >= d - g / 2 - g / 2 = 2 r + slack after it; if g = 0, at least d. A disc that
// keeps its centre on the near side of the plane through a convex obstacle's nearest point, r away, keeps off all of it.
// So u = 0 always satisfies all limits, and all reads are of the state before the step.
//
// Found on a prototype; the follower's part, lambda, is this program's own.

#include <cstdint>
#include <span>
#include <vector>

#include "crowd_client/agents.hpp"
#include "crowd_client/biocrowds.hpp"
#include "crowd_client/body_cells.hpp"
#include "crowd_client/obstacles.hpp"

namespace wade::crowd {

// The numbers of the rule. Each rule of the scene is one set of them.
struct BodyStyle {
    double lead_time = 0;         // tau, s
    double lead_length = 0;       // l, m; used where it is above 0
    double side_turn = 0;         // phi, rad
    double detour_turn = 0;       // alpha, rad
    double discount = 0;          // delta, [0, 1)
    double contest_distance = 0;  // D, m
    double blocked_share = 0;     // beta: blocked is who does less than this share
    bool of_the_wish = false;     // of the wished step, but of v0 dt / 2 at most; else of v0 dt
    double patience = 1;          // T_b, s
    double spacing_rate = 0;      // gamma, 1/m2; 0: speed does not depend on A
    double least_ground = 0;      // A0, m2
    bool only_followers = false;  // lambda as it is found; else 1
};
[[nodiscard]] BodyStyle body_style(BodyRule rule);

struct Bodies {
    BodyRule rule = BodyRule::none;
    BodyStyle style;
    double radius = 0.25;  // r, m

    // Working memory of a step, by place in the list of the active.
    std::vector<Vector2d> site, velocity, turned_goal;
    std::vector<double> desired_speed, discount;
    std::vector<double> followed;  // share of those near who walk the same way, now
    BodyCells cells;
    std::vector<Vector2d> step;  // u, m
};

constexpr double body_slack = 1e-4;  // m, kept between bodies so that rounding never makes them overlap

// Fills `walkers` with what bodies need to claim markers. goal_offsets and positions by place in `active`.
void prepare_bodies(Bodies& bodies, Walkers& walkers, const Agents& agents, std::span<const std::uint32_t> active,
                    std::span<const Vector2d> positions, std::span<const Vector2d> goal_offsets, const World& world,
                    double perception_radius, int threads);

// The walking velocity that agent `id`, at place k, wishes for, m/s; updates its kappa and lambda.
[[nodiscard]] Vector2d wished_velocity(const Bodies& bodies, Agents& agents, std::uint32_t id, std::size_t k,
                                       const Motion& motion, double marker_area, SpeedRule rule, double dt);

// Of the wishes, m, the steps that overlap nobody, into bodies.step. may_fall: who may leave the world at x = 0.
void limit_steps(Bodies& bodies, const Walls& walls, std::span<const Vector2d> positions,
                 std::span<const Vector2d> wishes, const std::vector<bool>& may_fall, int threads);

// Whether the way was blocked, after a step u that was left of the walking wish w, both in m.
void note_blocked(const Bodies& bodies, Agents& agents, std::uint32_t id, const Vector2d& u, const Vector2d& w,
                  double dt);

// Moves people apart who start closer than two radii, or closer to an obstacle than one. Throws ConfigurationError if there
// is no room.
void make_room_for_bodies(Agents& agents, const Walls& walls, double radius);

}  // namespace wade::crowd
