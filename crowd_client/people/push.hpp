#pragma once
// Two-way momentum exchange of a person with the water: the drag, as an impulse that the water loses, and the wake.
//
//   k  = rho C B min(h, H) / 2,  u = U - V        drag k |u| u; U the mean over the cone of felt_water.hpp, V the person's velocity
//   theta F / S                                   deceleration of U by a force F
//
// The sampling cone of radius R acts as a soft disc of the width W_e: the drag itself slows U below the upstream
// velocity. Momentum theory of an actuator disc (Glauert 1935) gives the C on U that yields the drag of C_D on the
// upstream flow:
//
//   C_T = C_D B / W_e <= 0.8,   C = C_D * 4 / (1 + sqrt(1 - C_T))^2
//
//   W_e = 1.5 R                    of cells; 1.43 R in theory, 1 over the integral of the squared cone's profile
//   W_e = R (1.6 + 0.011 / Fr^3)   of particles, Fr = |U| / sqrt(g h): they mix within the disc [A], the more the longer they
//                                  take to pass and the deeper they are
//
// Fitted to the drag of a standing person in 0.5 to 2.5 m/s and 0.5 to 1.5 m (spacing 0.25 m), where W_e / R is 1.3 to
// 8. The drag is then right within 3 %, at 2.5 m/s within 6 %. Fr uses the stream's U and not u, as the stream mixes
// [A].

#include "configs/scene/fluid.hpp"
#include "configs/scene/scene.hpp"
#include "crowd_client/equations.hpp"

namespace wade::crowd {

// |U|, m/s, h, m, and g, m/s2.
struct Stream {
    double speed = 0, depth = 0, gravity = 0;
};

// Returns W_e / R for the fluid model at people, infinite for particles at rest. `mixed` has particles there.
[[nodiscard]] double disc_width_share(ModelKind model, const Stream& stream);

// Returns C of a body of width B, m, with two-way exchange over a disc of the width W_e, m.
[[nodiscard]] double drag_on_slowed_stream(double drag, double body_width, double disc_width);

// Sampled water near a person with two-way exchange.
struct PushedWater {
    Vector2d relative = Vector2d::Zero();  // u, m/s
    double weight = 0;                     // S, kg
    double theta = 0;
};

// Returns the largest impulse, N s, that a person takes in a step: 0.5 |u| S / theta, which halves |u|. The stream
// renews the water in the cone, so that the drag of a long step does not decay as in a pond. But no step takes more
// than half.
[[nodiscard]] double largest_push(const PushedWater& water);

// Returns J = min(k |u| u dt, largest_push), N s, of a person that stands or walks.
[[nodiscard]] Vector2d push_of_walker(double k, const PushedWater& water, double dt);

// Returns J of a person carried by the water. The drag reverses neither person nor water, however long the step:
// |u'| = |u| / (1 + kappa |u| dt), kappa = k (theta / S + 1 / M), J = (|u| - |u'|) / (theta / S + 1 / M).
[[nodiscard]] Vector2d push_of_carried(double k, double mass, const PushedWater& water, double dt);

// Wake shielding by people: particles of 0.1 to 0.5 m, and cells, are too coarse to resolve these wakes.
//
//   delta = min(1, sqrt(C_D B / x)) exp(-4.5 y^2 / (C_D B x))    relative velocity deficit, x downstream, y across
//
// Blevins (2005), the wake of a cylinder, for B / 2 < x <= 20 m behind a body of width B. In several wakes the largest
// deficit counts. The deficit that the fluid model itself resolves, `resolved`, is subtracted: nothing with particles,
// which mix it away within metres; C_D B / (2 W_e) with cells, as wakes in cells never end.
//
// For a file the remaining drag is as measured in dense groups (Li et al. 2026: mean drag -85 %). For a random crowd of
// 0.5 people/m2 it is 0.42 of the drag, against 0.6 to 0.7 in Nepf (1999).

inline constexpr double longest_wake = 20;  // m

// Returns delta behind a body of C_D B = `drag_width` m, B = `width` m; 0 beside and upstream of the wake.
[[nodiscard]] double wake_deficit(double drag_width, double width, double along, double across);

// Returns the lateral distance, m, beyond which delta is below 0.001 for bodies of at most C_D B = `drag_width` m.
[[nodiscard]] double widest_wake(double drag_width);

}  // namespace wade::crowd
