#pragma once
// Body poses for animation: states change at once, poses follow smoothly. Poses do not affect the motion of people.
//
// The aims of a pose may jump. The written values x follow them, x'' = -2 w x' - w^2 (x - aim), exact for any step. So
// x and x' do not jump, and |x'| <= w A / e, e = 2.718, if all aims lie within A of one another.
//
//   heading      direction of the legs' wanted velocity; turns at pi rad/s at most [A], and not below 0.1 m/s
//   gait         s = 0.004 n H min (Inman et al. 1981), step length s, m, of n steps a minute, so that s = sqrt(0.24 s H v), here v
//                the speed along the heading, also in water. Phase: number of strides of two steps, modulo 1
//   lean         against the stream: sin = (min(1, T) lambda - 0.04) / 0.55, the moment of the drag beyond that of the
//                feet, 0.04 H; a falling body leans downstream until it lies
//   hip          0.53 H upright (Drillis and Contini 1966); lying: half of a thickness of 0.25 m below the surface
//   turning      without ground: half of the vorticity of the water: as sampled about y; U / (2 h) about x and z, for a
//                lying body in a stream at rest at the bed [A]

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>

#include "crowd_client/people/people.hpp"

namespace wade::crowd {

using Vector3d = Eigen::Vector3d;

inline constexpr double body_pace = 5;                    // w of bodies, 1/s: nine tenths of a change after 0.8 s [A]
inline constexpr double speed_pace = 20.0 / 3;            // w of velocities, 1/s: 0.3 s behind
inline constexpr double fastest_turn = std::numbers::pi;  // by the legs, rad/s
inline constexpr double fastest_tumbling = 2;             // about each axis, rad/s [A]
inline constexpr double hip_share = 0.53;                 // of H, standing
inline constexpr double body_thickness = 0.25;            // of a lying body, m

// A value that follows its aim.
template <typename T>
struct Smoothed {
    T value, rate;
};

// Advances a value by dt towards a constant aim; pace: w.
template <typename T>
void follow(Smoothed<T>& smoothed, const T& aim, double pace, double dt) {
    const double decay = std::exp(-pace * dt);
    const T away = smoothed.value - aim;
    const T pull = smoothed.rate + pace * away;
    smoothed.value = aim + (away + dt * pull) * decay;
    smoothed.rate = (smoothed.rate - pace * dt * pull) * decay;
}

// A flickering condition with hysteresis: it begins once it has held in half of the last 0.3 s, low-passed, and ends at
// a fifth. It lasts at least 0.27 s, with at least 0.14 s before the next one.
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
    LastingCondition swept;                            // with a given tau: the water tumbles the person
    double depth = 0;                                  // h, low-passed with 0.3 s, m
    Vector2d flow = Vector2d::Zero();                  // h U, the same, m2/s
    double fallen = 0;                                 // direction of the fall, rad as the heading
    Smoothed<double> heading{0, 0};                    // rad from x towards z, counts on beyond 2 pi
    Smoothed<Vector2d> velocity{{0, 0}, {0, 0}};       // m/s
    Smoothed<Vector2d> wish{{0, 0}, {0, 0}};           // wanted by the legs, m/s
    Smoothed<Vector2d> lean{{0, 0}, {0, 0}};           // out of the vertical towards x and z, rad
    Smoothed<double> step_length{0, 0};                // m
    double gait_phase = 0;                             // [0, 1)
    Smoothed<double> hip{0, 0};                        // height above the bed, m
    Smoothed<Vector3d> turning{{0, 0, 0}, {0, 0, 0}};  // about x, y, z, rad/s; about y from z towards x
};

// Input of a step of the pose.
struct PoseStep {
    double dt = 0;                         // s
    double depth = 0;                      // h sampled, m
    Vector2d stream = Vector2d::Zero();    // U sampled, m/s
    double spin = 0;                       // half of the vorticity about y, rad/s; used without ground
    Vector2d velocity = Vector2d::Zero();  // of the person, m/s
    Vector2d wanted = Vector2d::Zero();    // by the legs, m/s
    double mass = 0;                       // of the person, kg
    WaterProperties water;
};

// Returns the pose of a person that stands on dry ground and looks along `heading`.
[[nodiscard]] Pose standing_pose(const People& people, std::size_t id, const Vector2d& heading);

// Returns the posture for a person's state. With a given tau, `swept` is true if the water tumbles the person.
[[nodiscard]] Posture posture_of(const People& people, std::size_t id, bool swept);
[[nodiscard]] bool has_ground(Posture posture);

// Returns the low-passed U, m/s.
[[nodiscard]] Vector2d mean_stream(const Pose& pose);

// Advances the pose by a step.
void advance_pose(Pose& pose, const People& people, std::size_t id, Posture posture, const PoseStep& step);

// Return the step length, m, at a speed, m/s, and the steps a second at that length; height: H, m.
[[nodiscard]] double step_length_at(double speed, double height);
[[nodiscard]] double cadence_of(double step_length, double height);

}  // namespace wade::crowd
