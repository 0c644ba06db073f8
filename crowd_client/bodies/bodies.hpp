#pragma once
// Agents with bodies: discs that never overlap, and that get past one another.
//
// BioCrowds keeps points apart. Here each agent is a disc of radius r_i. It claims markers ahead of itself and
// discounts markers that another agent is about to reach. The limits below cut its desired step down to one without
// overlap. A pressed agent turns its shoulders, an agent with oncoming people passes on the right, a jammed agent steps
// back.
//
// Decisions, every T (body_clock.hpp), from the state at the last one:
//
//   site       q = p + Rot(-phi min(1, 3 kappa)) tau v, at most 1 m ahead; Rot(-angle) turns to the right
//   claims     a marker a belongs to the agent with the nearest q, within R
//   discount   a is contested if |a - (p_j + v_j d / v0)| < D for another j with a site that reaches the marker's
//              cell, d = |a - p|; its preference f (Eq. 3) is then multiplied by 1 - delta
//   goal       turned to the right by alpha b before Eq. 3. While o <= 0.05, the side changes after each 5 s with
//              b > 0.9, as in a corner
//   wish       the desired velocity: F v_B, v_B of Eq. 4,
//              F = 1 - lambda exp(-gamma A_f (1 + (A / A_0)^6 (1 - lambda))), A_f = max(0, A - a);
//              or, if the agent yields, 0.3 m/s opposite to the turned goal direction. While s > 2 s and o < 0.1, it
//              yields in a random 30 % of the seconds
//
// Motion, in each step and at most h = 0.06 s long, of the wish w = h (desired velocity, changed by the water):
//
//   shoulders  r_i shrinks towards r - (r - 0.72 r) clamp((c - low) / (high - low)), at most by 0.3 m/s; (low, high) is
//              (0.4, 1), and (0, 0.7) for o > 1/3, linear between. A radius below its aim grows by dr, at most 0.15 m/s
//              and half of each limit
//   limits     u.n <= sigma g - dr for each neighbour, g = max(0, d_ij - r_i - r_j - slack), n = (p_j - p) / d_ij,
//              sigma = 1 - 2^(-h / 0.05 s), at most 1/2
//              u.n <= g - dr for each obstacle, g = max(0, d - r_i - slack), and u.n <= g for each edge of the world
//   step       u: w slid along the limit that it breaks most, twice, then shortened until it keeps all; p += u
//
//   p       position                                        v0      desired speed
//   v       displacement since the last decision / T        r       /crowd/body_radius_m
//   kappa   contested fraction of the agent's markers,      A       area of the agent's own markers
//           over 0.4 s                                      a       area that the body covers, pi (0.72 r)^2
//   b       fraction of the time with |v| < beta F v0,      c       fraction of the wish that was lost,
//           over T_b; the bound scales with the fraction            1 - u.w / w^2, over 1 s
//           of v_B that the water leaves
//   lambda  mean cosine, >= 0, between the agent's heading and the headings within 1.5 m, without oncoming ones
//           (cosine < -0.85), over 1 s
//   o       opposed: fraction of the neighbours in the strip ahead that come towards the agent,
//           sum w max(0, -cos) / sum w, w = 1 / (0.5 m + a), a < 2.5 m ahead and at most 1 m + a / 4 aside, over 0.5 s.
//           cos is the greater of two cosines, between the routes and between the bearings of the goals, so that people
//           merging at a door do not oppose one another
//   s       time standing (|v| < v0 / 10) less twice the time not standing, in [0, 10] s
//
// No overlap, for any wish and any push. Let d >= r_i + r_j be the distance of i and j before a motion. Shrinking radii
// keep this true. If g > 0, the distance is afterwards at least
//
//   d - u_i.n + u_j.n >= d - (g / 2 - dr_i) - (g / 2 - dr_j) = r_i + dr_i + r_j + dr_j + slack;
//
// if g = 0, neither radius grows and it is at least d. For an obstacle, take the plane r_i + dr before its nearest
// point, normal to the line from the centre to that point. A centre that stays on its side of the plane keeps the disc
// clear of the whole convex obstacle, for any step length. u = 0 keeps all limits.
// r_i is the current radius: turned shoulders narrow a body to 0.72 of its width, not further.
//
// Why no agent blocks for ever. Two that wedge side by side between jambs lose all of their wish, c -> 1, and turn: in
// a door of 4 x 0.72 r, 0.72 m for r = 0.25 m, and more both then have room. In a narrower door they stand, and after
// 2 s each yields at random in 30 % of the seconds. Exactly one yields in 42 % of the seconds, and the other gets
// through. Two that meet face to face turn at once (o) and pass on the same side (the right), so that neither waits.
// This is no proof that agents leave every jam. wade verify-crowd tests 71 widths of doors, two-way doors, corridors
// and crossings.
//
// Why sigma. Followers close a gap by halves. If a step of any length closed half of the gap, the gap that they keep
// would be 2 v times the step, and the flow through a door would depend on the time step. With sigma, each side leaves
// 2^(-h / 0.05 s) of the gap after h, whatever h up to 0.05 s.
//
// `fast` has lambda = 0. `human` follows: speed falls as the free area shrinks, but only among people with one
// direction, as in the corridors where speed over density is measured. An agent that crosses gets through as with
// `fast`. Oncoming agents are passed, not followed. An agent with more area than A_0 is not slowed by a few neighbours
// that walk in its direction.
// Why b is measured against F v0. A queue in one direction moves at F v0, and no agent in it is blocked. Against v0
// alone, b nears 1 above 2 people/m2: goals turn by up to alpha, and at 3 people/m2 a third of the motion goes
// sideways.
// Why a. The ground under the agent's own body leaves no room to walk: F falls to 1 - lambda where bodies touch.
// One set of numbers for all scenes. gamma, beta = 0.6 (`fast`: 0.5), low, phi and D are fitted to speed over density
// in corridors, between Weidmann's curve and the speeds of Zhang et al. 2011, and to the flow through openings of 0.8
// to 1.6 m. A_0 and its power are fitted, as far as these fits leave them free, to the goals reached on a crossing
// plane. The cosine of oncoming agents and the 0.7 of (low, high) were chosen with two-way flow in view. With 0.6 or
// 0.8 all limits of two-way flow, two-way doors, IMO test 8, blocks and crossings hold; with a cosine of -0.7 the
// slowest of ten runs of IMO test 8 takes 126 s of 120.
// 0.72 r of 0.25 m is 0.18 m: a disc between the half depth of a chest, 0.12 to 0.15 m, and a disc of the area of the
// ellipse of chest and shoulders, 0.19 m.

#include <cstdint>
#include <span>

#include "configs/scene/crowd.hpp"
#include "configs/scene/interval.hpp"
#include "crowd_client/agents.hpp"
#include "crowd_client/bodies/body_clock.hpp"
#include "crowd_client/bodies/body_state.hpp"
#include "crowd_client/markers/biocrowds.hpp"
#include "crowd_client/navigation/obstacles.hpp"

namespace wade::crowd {

inline constexpr double body_slack = 1e-4;  // m, kept between bodies so that rounding never makes them overlap

// Initialises the bodies of agents before their first step.
void begin_bodies(Agents& agents, double radius);

// Updates the memories over the time since the last decision, if there was one, and fills `walkers` with the data by
// which bodies claim markers. goal_offsets along the routes, and positions, by index in `active`, m.
void prepare_bodies(Bodies& bodies, Walkers& walkers, Agents& agents, std::span<const std::uint32_t> active,
                    std::span<const Vector2d> positions, std::span<const Vector2d> goal_offsets, const World& world,
                    double perception_radius, const Decision& decision, int threads);

// Returns the desired walking velocity of agent `id`, at index k, m/s; updates its kappa, lambda and o.
[[nodiscard]] Vector2d wished_velocity(const Bodies& bodies, Agents& agents, std::uint32_t id, std::size_t k,
                                       const Motion& motion, double marker_area, SpeedRule rule,
                                       const Decision& decision);

// Limits the desired steps of a time dt, m, to steps without overlap, in bodies.step. Turns shoulders, and adds to the
// wished and actual displacements of each agent. ends: bounds of each agent along x, m.
void limit_steps(Bodies& bodies, Agents& agents, std::span<const std::uint32_t> active, const Walls& walls,
                 std::span<const Vector2d> positions, std::span<const Vector2d> wishes, std::span<const Interval> ends,
                 double dt, int threads);

// Moves agents apart that start closer than two radii, or closer than one radius to an obstacle. Throws
// ConfigurationError if there is no room.
void make_room_for_bodies(Agents& agents, const Walls& walls, double radius);

}  // namespace wade::crowd
