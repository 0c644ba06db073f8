#pragma once
// How a person holds itself, for animators: states are words that change at once, bodies are not. Nobody is moved by it.
//
// What a pose aims at changes when it likes; what is written follows it, x'' = -2 w x' - w^2 (x - aim), exact for any step. So x and x'
// do not jump, and |x'| <= w A / e, e = 2.718, if all aims lie within A of one another.
//
//   heading      where the legs want to go; they turn at pi rad/s at most [A], and not while they want nothing
//   gait         s = 0.004 n H min (Inman et al. 1981), step length s, m, of n steps a minute, so that s = sqrt(0.24 s H v), here v
//                the speed along the heading; slower in water as its speed is. Phase: strides of two steps, the rest of 1
//   lean         against the stream: sin = (min(1, T) lambda - 0.04) / 0.55, what the feet, 0.04 H, leave of the moment of the
//                drag; who falls goes downstream, until he lies
//   hip          0.53 H upright (Drillis and Contini 1966); of who lies half of a body's thickness, 0.25 m, below the surface
//   turning      of who has no ground half of the vorticity of the water: about y as felt, about x and z of a stream that rests at
//                the bed, U / h [A]

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>

#include "crowd_client/people/people.hpp"

namespace wade::crowd {

using Vector3d = Eigen::Vector3d;

inline constexpr double body_pace = 5;                    // w of bodies, 1/s: nine tenths of the way after 0.8 s [A]
inline constexpr double speed_pace = 20.0 / 3;            // w of velocities, 1/s: 0.3 s behind
inline constexpr double fastest_turn = std::numbers::pi;  // of who turns by himself, rad/s
inline constexpr double fastest_tumbling = 2;             // about each axis, rad/s [A]
inline constexpr double hip_share = 0.53;                 // of H, of who stands
inline constexpr double body_thickness = 0.25;            // of who lies, m

// A value that follows its aim.
template <typename T>
struct Smoothed {
    T value, rate;
};

// After dt in which the aim stays; pace: w.
template <typename T>
void follow(Smoothed<T>& smoothed, const T& aim, double pace, double dt) {
    const double decay = std::exp(-pace * dt);
    const T away = smoothed.value - aim;
    const T pull = smoothed.rate + pace * away;
    smoothed.value = aim + (away + dt * pull) * decay;
    smoothed.rate = (smoothed.rate - pace * dt * pull) * decay;
}

// A condition that holds now and then, as one that lasts: it begins once it has held in half of the last 0.3 s, low-passed, and ends at
// a fifth. It lasts 0.27 s at least, and 0.14 s lie between two.
struct LastingCondition {
    double share = 0;
    bool holds = false;
};
void note(LastingCondition& lasting, bool holds_now, double dt);

enum class Posture : std::uint8_t { upright, falling, lying, floating, swimming, sitting, kneeling, squatting, rising };
inline constexpr std::array<std::string_view, 9> postures{"upright", "falling",  "lying",     "floating", "swimming",
                                                          "sitting", "kneeling", "squatting", "rising"};

struct Pose {
    Posture posture = Posture::upright;
    LastingCondition swept;                            // of who answers by a given tau: the water tumbles him
    double depth = 0;                                  // h, low-passed with 0.3 s, m
    Vector2d flow = Vector2d::Zero();                  // h U, the same, m2/s
    double fallen = 0;                                 // direction in which it fell, rad as the heading
    Smoothed<double> heading{0, 0};                    // rad from x towards z, counts on beyond 2 pi
    Smoothed<Vector2d> velocity{{0, 0}, {0, 0}};       // m/s
    Smoothed<Vector2d> wish{{0, 0}, {0, 0}};           // of the legs, m/s
    Smoothed<Vector2d> lean{{0, 0}, {0, 0}};           // out of the vertical towards x and z, rad
    Smoothed<double> step_length{0, 0};                // m
    double gait_phase = 0;                             // [0, 1)
    Smoothed<double> hip{0, 0};                        // height above the bed, m
    Smoothed<Vector3d> turning{{0, 0, 0}, {0, 0, 0}};  // about x, y, z, rad/s; about y from z towards x
};

// Of a step.
struct PoseStep {
    double dt = 0;                         // s
    double depth = 0;                      // h felt, m
    Vector2d stream = Vector2d::Zero();    // U felt, m/s
    double spin = 0;                       // half of the vorticity about y, rad/s; of who has no ground
    Vector2d velocity = Vector2d::Zero();  // of the person, m/s
    Vector2d wanted = Vector2d::Zero();    // by the legs, m/s
    double mass = 0;                       // of the person, kg
    WaterProperties water;
};

// Of somebody who stands, on dry ground, and looks along `heading`.
[[nodiscard]] Pose standing_pose(const People& people, std::size_t id, const Vector2d& heading);

// The posture that goes with a person's state; of who answers by a given tau `swept` says whether the water tumbles him.
[[nodiscard]] Posture posture_of(const People& people, std::size_t id, bool swept);
[[nodiscard]] bool has_ground(Posture posture);

// U low-passed, m/s.
[[nodiscard]] Vector2d mean_stream(const Pose& pose);

// The pose after a step.
void advance_pose(Pose& pose, const People& people, std::size_t id, Posture posture, const PoseStep& step);

// Length of a step and steps in a second at a speed, m/s, of somebody of height H, m.
[[nodiscard]] double step_length_at(double speed, double height);
[[nodiscard]] double cadence_of(double step_length, double height);

}  // namespace wade::crowd
