#pragma once
// The nine equations of the model, one pure function each.
//
// Source: Schaffer, Antonitsch, Neto, Musse, "Towards Animating Virtual Humans in Flooded Environments", MIG 2020;
// Eq. 1-4 are BioCrowds (de Lima Bicho et al. 2012). All vectors lie in the ground plane, (x, z), SI units.

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <span>

#include "configs/scene/crowd.hpp"
#include "configs/scene/scene.hpp"

namespace wade::crowd {

using Vector2d = Eigen::Vector2d;

// Returns v over its length; `otherwise` for a length below 1e-154, which is rest.
[[nodiscard]] inline Vector2d unit_or(const Vector2d& v, const Vector2d& otherwise) {
    const double square = v.squaredNorm();
    // The square of a length below 1e-154 has lost digits, and v / |v| may be longer than 1.
    return square >= std::numeric_limits<double>::min() ? Vector2d(v / std::sqrt(square)) : otherwise;
}

// One particle of the water in contact with an agent, in the ground plane.
struct WaterParticle {
    double mass = 0;                       // kg
    Vector2d velocity = Vector2d::Zero();  // m/s
};

// Mass and momentum of all particles in contact with an agent.
struct Contact {
    double mass = 0;                       // sum of m_i, kg
    Vector2d momentum = Vector2d::Zero();  // sum of m_i v_i, kg m/s
};

// Eq. 1 to 3 as published, as a reference for tests: markers/fixed_owners.cpp has them in the order of the markers,
// to the bit, and markers/drawn_owners.cpp with one division per marker.

// Eq. 1: the motion vector m = sum_k w_k (a_k - X), m.
// weights: w_k of Eq. 2; marker_offsets: a_k - X of the agent's own markers, m; both of the same length.
[[nodiscard]] Vector2d motion_vector(std::span<const double> weights, std::span<const Vector2d> marker_offsets);

// Eq. 2: the weight of a marker, w_k = f_k / sum_l f_l, in [0, 1].
// preference: f_k of Eq. 3; preference_sum: over the agent's own markers. 0 if the sum is 0, which happens when every
// marker lies exactly opposite to the goal.
[[nodiscard]] double marker_weight(double preference, double preference_sum);

// Eq. 3: the preference for a marker, f = (1 + cos theta) / (1 + |a_k - X|), in [0, 2].
// goal_offset: goal - X, m; marker_offset: a_k - X, m; theta: the angle between them. cos theta is taken as 0 where an
// offset is zero (the agent stands on its goal or on the marker), where the source divides 0 by 0.
[[nodiscard]] double marker_preference(const Vector2d& goal_offset, const Vector2d& marker_offset);

// Eq. 4: the walking velocity v_B = s m / |m|, m/s; zero for m = 0.
// The source limits s by |m| without stating a unit of time; the three interpretations:
//   pi          s = min(pi |m| s_max, s_max) per second, as its authors' program does; walks freely at 0.99 s_max
//   per_frame   s = min(|m|, s_max dt) per step
//   per_second  s = min(|m|, s_max) per second; walks freely at about 0.31 m/s
// motion: m of Eq. 1, m; desired_speed: s_max, m/s; dt: length of a step, s.
[[nodiscard]] Vector2d walking_velocity(const Vector2d& motion, double desired_speed, SpeedRule rule, double dt);

// Eq. 5: the momentum of the particles in contact with an agent, sum m_i v_i in kg m/s, with their mass sum m_i in kg.
[[nodiscard]] Contact contact_momentum(std::span<const WaterParticle> particles);

// Eq. 6: momentum of the agent and the water in contact with it before they meet, p = m_a v_B + sum m_i v_i, kg m/s.
// agent_mass: m_a, kg; walking: v_B of Eq. 4, m/s; water: Eq. 5.
[[nodiscard]] Vector2d momentum_before(double agent_mass, const Vector2d& walking, const Contact& water);

// Eq. 7: mass that moves on together after a perfectly inelastic collision, M = m_a + sum m_i, kg.
[[nodiscard]] double mass_after(double agent_mass, const Contact& water);

// Eq. 8: the fraction tau of the water's mass and momentum that acts on an agent: tau sum m_i and tau sum m_i v_i.
// tau in [0, 1] is the susceptibility, "endurance" in the paper: 0 is not moved at all, 1 is moved like a passive body.
[[nodiscard]] Contact yielded_water(double tau, const Contact& water);

// Eq. 9: the agent's new velocity, v^{t+1} = (m_a v_B + tau sum m_i v_i) / (m_a + tau sum m_i), m/s: Eq. 6 over Eq. 7
// with the water of Eq. 8. It starts from v_B each step anew, an agent has no inertia of its own. Without water or
// with tau = 0 the result is v_B itself, bit for bit. Needs agent_mass > 0.
[[nodiscard]] Vector2d coupled_velocity(double agent_mass, const Vector2d& walking, double tau, const Contact& water);

// T of the rule `continuous`: the length of a frame of the source, s.
inline constexpr double response_time = 1.0 / 30;

// Eq. 9 in continuous time, for steps of any length; the rule `continuous`.
//
// Eq. 9 gives the velocity that balances the pushes of legs and water,
//
//   m_a (v_B - v) + tau sum m_i (v_i - v) = 0   <=>   v = v_inf = (m_a v_B + tau sum m_i v_i) / (m_a + tau sum m_i),
//
// and sets the agent to it at once, in each frame of the source, T = 1/30 s. Here the agent tends to it within T:
//
//   dv/dt = -(v - v_inf) / T
//
// With v_B and the water held over a step dt this is solved exactly, for any dt:
//
//   v(t + dt)         = v_inf + (v(t) - v_inf) q,                          q = exp(-dt / T)
//   x(t + dt) - x(t)  = v_inf dt + (v(t) - v_inf) T (1 - q)
//
// Both are used, so that velocity and path are the same for steps of any length; after a jump of v_inf by u the agent
// ends up T u behind an agent of Eq. 9.
//
// Steady state: that of Eq. 9 for every dt, without error. Fluctuating water: the equation is linear in v_inf with a
// constant T, so that the velocity on average over time is the average of v_inf, as with Eq. 9, for every dt. (It would
// not be so with legs and water as forces m_a (v_B - v)/T and tau sum m_i (v_i - v)/T, which answer faster the more
// water touches, in T m_a / (m_a + tau sum m_i): then the average depends on whether dt resolves this time.)
// The sampling rate of the water and the markers still matters.
//
// velocity: v(t), m/s; the others as in Eq. 9; dt > 0, s. Without water or with tau = 0 the velocity tends to v_B.
struct RelaxedVelocity {
    Vector2d mean;    // over the step, (x(t + dt) - x(t)) / dt, m/s
    Vector2d at_end;  // v(t + dt), m/s
};
[[nodiscard]] RelaxedVelocity relaxed_velocity(double agent_mass, const Vector2d& velocity, const Vector2d& walking,
                                               double tau, const Contact& water, double dt);

}  // namespace wade::crowd
