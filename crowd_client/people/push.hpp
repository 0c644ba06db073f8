#pragma once
// What a person takes from the water that it stands or floats in: the drag, as an impulse that the water loses; and the lee that
// it leaves.
//
//   k  = rho C B min(h, H) / 2,  u = U - V        drag k |u| u; U the mean over the cone of felt_water.hpp, V the person's velocity
//   theta F / S                                   how fast a force F slows U itself
//
// A cone of radius R is a soft disc of the width W_e: U is slower than the stream, by the very drag. Momentum theory of an
// actuator disc (Glauert 1935) gives the coefficient on U with which the drag is that of C_D on the stream that comes:
//
//   C_T = C_D B / W_e <= 0.8,   C = C_D * 4 / (1 + sqrt(1 - C_T))^2
//
//   W_e = 1.5 R                    of cells; 1.43 R in theory, 1 over the integral of the squared cone's profile
//   W_e = R (1.6 + 0.011 / Fr^3)   of particles, Fr = |U| / sqrt(g h): they mix within the disc [A], the more the longer they
//                                  take to pass and the deeper they are
//
// Fitted to the drag of one who stands in 0.5 to 2.5 m/s and 0.5 to 1.5 m (spacing 0.25 m), where W_e / R is 1.3 to 8. The drag is
// then right within 3 %, at 2.5 m/s within 6 %. It is the stream's U and not u, as it is the river that mixes [A].

#include "configs/scene/fluid.hpp"
#include "configs/scene/scene.hpp"
#include "crowd_client/equations.hpp"

namespace wade::crowd {

// |U|, m/s, h, m, and g, m/s2.
struct Stream {
    double speed = 0, depth = 0, gravity = 0;
};

// W_e / R of what the scene's model gives people to push, infinite in still particles; `mixed` has particles there.
[[nodiscard]] double disc_width_share(ModelKind model, const Stream& stream);

// C of a body of width B, m, that pushes water over a disc of the width W_e, m.
[[nodiscard]] double drag_on_slowed_stream(double drag, double body_width, double disc_width);

// What is felt of the water near a person that pushes it.
struct PushedWater {
    Vector2d relative = Vector2d::Zero();  // u, m/s
    double weight = 0;                     // S, kg
    double theta = 0;
};

// The largest impulse, N s, that a person takes in a step: 0.5 |u| S / theta, which halves |u|. The stream renews the water in the
// cone, so that a drag of a long step is not that of a pond, but more than half of it is not there to be taken.
[[nodiscard]] double largest_push(const PushedWater& water);

// J = min(k |u| u dt, largest_push), N s, of who stands or walks.
[[nodiscard]] Vector2d push_of_walker(double k, const PushedWater& water, double dt);

// J of who is carried, so that neither it nor the water is turned round by the drag, however long the step:
// |u'| = |u| / (1 + kappa |u| dt), kappa = k (theta / S + 1 / M), J = (|u| - |u'|) / (theta / S + 1 / M).
[[nodiscard]] Vector2d push_of_carried(double k, double mass, const PushedWater& water, double dt);

// The lee of people: a wake that particles of 0.1 to 0.5 m, and cells, are too coarse for.
//
//   delta = min(1, sqrt(C_D B / x)) exp(-4.5 y^2 / (C_D B x))    of the velocity is missing at x downstream, y across
//
// Blevins (2005), the wake of a cylinder, for B / 2 < x <= 20 m, of somebody upstream whose body is B wide. Who stands in several
// wakes feels the deepest one. What the water itself shows of a wake is left out of it, `resolved`: nothing in particles, which mix it
// away within metres; C_D B / (2 W_e) in cells, whose wakes never end.
//
// Of a file it leaves what was measured of dense groups (Li et al. 2026: mean drag -85 %); of a random crowd of 0.5 people/m2 it
// leaves 0.42, where Nepf (1999) has 0.6 to 0.7.

inline constexpr double longest_wake = 20;  // m

// delta behind a body of C_D B = `drag_width` m, B = `width` m; 0 beside and upstream of the wake.
[[nodiscard]] double wake_deficit(double drag_width, double width, double along, double across);

// Beyond this to the side wakes of bodies of at most C_D B = `drag_width` m take less than 0.001, m.
[[nodiscard]] double widest_wake(double drag_width);

}  // namespace wade::crowd
