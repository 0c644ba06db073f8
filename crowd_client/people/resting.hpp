#pragma once
// Stability of a body at rest on the ground in each posture of getting up. Pure functions.
//
//   H height, h depth, m     x = h / H     U velocity of the water, m/s     mu, lambda: standing (person.hpp)
//
//   posture  parts of the volume: share, from, to (of H)              top   B / H  l / H   friction
//   sits     0.678: 0, 0.52;    0.200: 0, 0.10;     0.122: 0, 0.08    0.52  0.21   0.25    min(mu, 0.45), of clothes [A]
//   kneels   0.678: 0.24, 0.75; 0.200: 0.03, 0.27;  0.122: 0, 0.08    0.75  0.16   0.15    the same
//   squats   0.678: 0.12, 0.62; 0.200: 0.08, 0.30;  0.122: 0, 0.27    0.62  0.18   0.08    mu
//   stands   0.633 x^2 + 0.367 x                                      1     0.16   lambda  mu
//
//   f = sum share clamp((x - from) / (to - from), 0, 1)       N = m g max(0, 1 - f rho / body_density)
//   k = rho C B min(h, top) / 2      S = k U^2 / (mu N)       T = k U^2 min(h, top) / 2 / (N l)       D = max(S, T, R)
//   R = (U / v_up)^2, v_up = 1.6 m/s, below 0.05 m times 0.05 m / h: people in faster water do not get up
//
// v_up is 0.8 of v_most (person.hpp) up to 0.16 m [A]. It does not rise with the depth, so that deeper water is not easier to rest in.
//
// The parts are head, trunk and arms; thighs; shanks and feet. Their fractions are usual segment masses; heights, widths and lever arms
// are assumed. In 1 m of water a person of 1.7 m and 70 kg presses the ground with 33 N when sitting.

#include <array>
#include <cstdint>

#include "crowd_client/people/person.hpp"

namespace wade::crowd {

enum class Rest : std::uint8_t { sits, kneels, squats, stands };
inline constexpr std::size_t rests = 4;

// Terms of the equations above, for one posture.
struct Stance {
    double k = 0;         // of the drag, kg/m
    double wet = 0;       // height of the body against the stream, m
    double weight = 0;    // N, N
    double friction = 0;  // mu
    double arm = 0;       // l, m
};

// Computes the stance at a depth, m. friction, arm: mu and l, m, when standing; drag: C of the upright body.
[[nodiscard]] Stance stance_of(Rest posture, const Body& body, double friction, double arm, double depth,
                               const WaterProperties& water, double drag = body_drag);

// Computes D of a fallen body at rest in a stream, m/s; infinite for a body without weight.
[[nodiscard]] double demand_at_rest(const Stance& stance, double depth, const Vector2d& stream);

}  // namespace wade::crowd
