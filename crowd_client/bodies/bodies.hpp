#pragma once
// People with bodies: discs that never overlap, and that get past one another.
//
// BioCrowds keeps points apart. Here each agent is a disc of radius r_i. It claims markers ahead of itself, discounts those
// that somebody else is about to reach, and of the step that it wishes for it takes what its limits leave. Who is pressed
// turns the shoulders, who meets others passes on the right, who stands in a crowd that wants the same way steps back.
//
// Decisions, every T (body_clock.hpp), from what was so at the last one:
//
//   site       q = p + Rot(-phi min(1, 3 kappa)) tau v, at most 1 m ahead; Rot(-angle) turns to the right
//   claims     a marker a belongs to the agent whose q is nearest, within R
//   discount   a is contested if |a - (p_j + v_j d / v0)| < D for another j whose site reaches the marker's cell,
//              d = |a - p|; its preference f (Eq. 3) is then multiplied by 1 - delta
//   goal       turned to the right by alpha b before Eq. 3; while o <= 0.05 to the other side after each 5 s with b > 0.9,
//              as in a corner
//   wish       F v_B, v_B of Eq. 4, F = 1 - lambda exp(-gamma A_f (1 + (A / A_0)^6 (1 - lambda))), A_f = max(0, A - a);
//              or, of who yields, 0.3 m/s back along the way: he has s > 2 s, o < 0.1, and chance wants it, in 30 % of the seconds
//
// Motion, in each step and at most h = 0.06 s long, of the wish w = h (velocity that the water leaves of it):
//
//   shoulders  r_i shrinks towards r - (r - 0.72 r) clamp((c - low) / (high - low)), at most by 0.3 m/s; (low, high) is
//              (0.4, 1), and (0, 0.7) for o > 1/3, linear between. Where it is to grow, it grows by dr, at most 0.15 m/s
//              and half of each limit
//   limits     u.n <= sigma g - dr for each neighbour, g = max(0, d_ij - r_i - r_j - slack), n = (p_j - p) / d_ij,
//              sigma = 1 - 2^(-h / 0.05 s), at most 1/2
//              u.n <= g - dr for each obstacle, g = max(0, d - r_i - slack), and u.n <= g for each edge of the world
//   step       u: w slid along the limit that it breaks most, twice, then shortened until it keeps all; p += u
//
//   p       place                                           v0      desired speed
//   v       way since the last decision / T                 r       /crowd/body_radius_m
//   kappa   contested share of the own markers, over 0.4 s  A       ground that the own markers stand for
//   b       share of the time with |v| < beta F v0,         a       ground that the body covers, pi (0.72 r)^2
//           over T_b; where water takes part of v_B,        c       share of the wish that was lost, 1 - u.w / w^2, over 1 s
//           half of the rest
//   lambda  mean cosine, >= 0, with the headings of those within 1.5 m but of those who face one (cosine < -0.85), over 1 s
//   o       opposed: of those in the strip ahead the share that comes towards one, sum w max(0, -cos) / sum w,
//           w = 1 / (0.5 m + a), a < 2.5 m ahead and at most 1 m + a / 4 aside, over 0.5 s. cos is the greater of those of
//           the ways and of the bearings of the goals, so that people who merge at a door do not oppose one another
//   s       time in which it stood (|v| < v0 / 10) less twice the time in which it did not, in [0, 10] s
//
// No overlap, whatever is wished and whatever pushes. Let d >= r_i + r_j be the distance of i and j before a motion. That
// radii shrink keeps it. If g > 0, the distance is afterwards at least
//
//   d - u_i.n + u_j.n >= d - (g / 2 - dr_i) - (g / 2 - dr_j) = r_i + dr_i + r_j + dr_j + slack;
//
// if g = 0, nobody grows and it is at least d. A disc whose centre stays on its side of the plane r_i + dr before a convex
// obstacle's nearest point, normal to the way there, keeps off all of it, however long the step. u = 0 keeps all limits.
// Bodies are those of the moment: shoulders that turn fit through 0.72 of a body's width, not more.
//
// Why nobody blocks for ever. Two who wedge side by side between jambs lose all of their wish, c -> 1, and turn: in a door of
// 4 x 0.72 r, 0.72 m for r = 0.25 m, and more both then have room. In a narrower one they stand, and after 2 s each yields by
// chance in 30 % of the seconds: one alone in 42 % of them, so that the other gets through. Two who meet face to face turn at
// once (o), and pass on the same side (the right), so that neither waits for the other. This is no proof that everybody gets
// out of everything: it is tried, at 71 widths of doors, in two-way doors, corridors and crossings (wade verify-crowd).
//
// Why sigma. People who follow close a gap by halves. Were it half of the gap in a step of any length, the gap that they
// keep would be 2 v times the step, and the flow through a door would depend on the rate of steps. In h it closes to
// 2^(-h / 0.05 s) of itself from either side, whatever h up to 0.05 s.
//
// `fast` has lambda = 0. `human` follows: speed falls with the ground that is free only among people who walk the same
// way, as in the corridors in which the speed over density is measured; who crosses gets through as with `fast`, and who
// faces one is passed, not followed. Who has more ground than A_0 is not held up by the few who happen to go his way.
// Why b is measured against F v0. A queue in which all go one way moves at F v0, and nobody in it is blocked. Against v0 alone,
// b nears 1 above 2 people/m2: goals turn by up to alpha, and at 3 people/m2 a third of the motion goes sideways.
// Why a. The ground under the own body leaves no room to walk: F falls to 1 - lambda where bodies touch.
// One set of numbers for all scenes. gamma, beta = 0.6 (`fast`: 0.5), low, phi and D are fitted to speed over density in corridors,
// between Weidmann's curve and the speeds of Zhang et al. 2011, and to the flow through openings of 0.8 to 1.6 m. A_0 and its power
// are fitted, within what these leave free, to the goals reached on a crossing plane. The cosine of those who face one and the 0.7
// of (low, high) were chosen with two-way flow in view. With 0.6 or 0.8 all limits of two-way flow, two-way doors, IMO test 8,
// blocks and crossings hold; with a cosine of -0.7 the slowest of ten runs of IMO test 8 takes 126 s of 120.
// 0.72 r of 0.25 m is 0.18 m: a disc between the half depth of a chest, 0.12 to 0.15 m, and a disc of the area of the ellipse
// of chest and shoulders, 0.19 m.

#include <cstdint>
#include <span>

#include "configs/scene/crowd.hpp"
#include "configs/scene/interval.hpp"
#include "crowd_client/agents.hpp"
#include "crowd_client/bodies/body_clock.hpp"
#include "crowd_client/bodies/body_state.hpp"
#include "crowd_client/markers/biocrowds.hpp"
#include "crowd_client/ways/obstacles.hpp"

namespace wade::crowd {

inline constexpr double body_slack = 1e-4;  // m, kept between bodies so that rounding never makes them overlap

// People who have not moved yet.
void begin_bodies(Agents& agents, double radius);

// Takes note of the time since the last decision, if there was one, and fills `walkers` with what bodies need to claim
// markers. goal_offsets along the ways, and positions, by place in `active`, m.
void prepare_bodies(Bodies& bodies, Walkers& walkers, Agents& agents, std::span<const std::uint32_t> active,
                    std::span<const Vector2d> positions, std::span<const Vector2d> goal_offsets, const World& world,
                    double perception_radius, const Decision& decision, int threads);

// The walking velocity that agent `id`, at place k, wishes for, m/s; updates its kappa, lambda and o.
[[nodiscard]] Vector2d wished_velocity(const Bodies& bodies, Agents& agents, std::uint32_t id, std::size_t k,
                                       const Motion& motion, double marker_area, SpeedRule rule,
                                       const Decision& decision);

// Of the wishes for a time dt, m, the steps that overlap nobody, into bodies.step; turns shoulders, and adds to what each
// one wished and went. ends: what holds each one along x, m.
void limit_steps(Bodies& bodies, Agents& agents, std::span<const std::uint32_t> active, const Walls& walls,
                 std::span<const Vector2d> positions, std::span<const Vector2d> wishes, std::span<const Interval> ends,
                 double dt, int threads);

// Moves people apart who start closer than two radii, or closer to an obstacle than one. Throws ConfigurationError if there
// is no room.
void make_room_for_bodies(Agents& agents, const Walls& walls, double radius);

}  // namespace wade::crowd
