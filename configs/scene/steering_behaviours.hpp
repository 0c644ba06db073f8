#pragma once
// Steering behaviours of Reynolds (1999), "Steering Behaviors For Autonomous Characters", Game Developers Conference.
//
// A vehicle has a mass, limits of force and speed, and the local frame of its velocity. Each behaviour returns the steering
// force as Reynolds writes it, the desired velocity less the present one, m/s; `steer` limits and applies it.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace wade::behaviours {

using Vector = std::array<double, 3>;

inline Vector plus(const Vector& a, const Vector& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vector minus(const Vector& a, const Vector& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Vector times(double s, const Vector& a) {
    return {s * a[0], s * a[1], s * a[2]};
}
inline double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const Vector& a) {
    return std::sqrt(dot(a, a));
}
// Direction of a; zero for zero.
inline Vector direction(const Vector& a) {
    const double l = length(a);
    return l > 0 ? times(1 / l, a) : Vector{};
}
// a, made no longer than `longest`.
inline Vector truncate(const Vector& a, double longest) {
    const double l = length(a);
    return l > longest ? times(longest / l, a) : a;
}

// Reynolds' simple vehicle model: a point mass with limits, and the frame that follows its velocity.
struct Vehicle {
    double mass = 1;                                      // kg
    Vector position{};                                    // m
    Vector velocity{};                                    // m/s
    double max_force = 1;                                 // N
    double max_speed = 1;                                 // m/s
    Vector forward{1, 0, 0}, up{0, 1, 0}, side{0, 0, 1};  // unit vectors, right-handed: forward x up = side
};

// The frame after the velocity has changed: forward along it, side = forward x up made normal, up = side x forward. A vehicle
// at rest keeps its frame; one that turns into its up direction keeps its side.
inline void align_frame(Vehicle& v) {
    const Vector forward = direction(v.velocity);
    if (dot(forward, forward) == 0) return;
    const Vector side = cross(forward, v.up);
    v.forward = forward;
    if (length(side) > 1e-9) v.side = direction(side);
    v.up = direction(cross(v.side, v.forward));
    v.side = cross(v.forward, v.up);
}

// One step of forward Euler as in Reynolds: force and speed are truncated, and the new velocity moves the vehicle.
inline void steer(Vehicle& v, const Vector& steering_force, double dt) {
    const Vector acceleration = times(1 / v.mass, truncate(steering_force, v.max_force));
    v.velocity = truncate(plus(v.velocity, times(dt, acceleration)), v.max_speed);
    v.position = plus(v.position, times(dt, v.velocity));
    align_frame(v);
}

// Returns whether the position `place` is in the neighbourhood of a vehicle: nearer than the radius, m, and its
// direction within `angle`, rad, of forward.
inline bool in_neighbourhood(const Vehicle& v, const Vector& place, double radius, double angle) {
    const Vector way = minus(place, v.position);
    const double r = length(way);
    return r < radius && dot(way, v.forward) >= std::cos(angle) * r;
}

// Returns the steering force that leads to full speed towards the target.
inline Vector seek(const Vehicle& v, const Vector& target) {
    return minus(times(v.max_speed, direction(minus(target, v.position))), v.velocity);
}

// Returns the steering force that leads to full speed away from the threat.
inline Vector flee(const Vehicle& v, const Vector& threat) {
    return minus(times(v.max_speed, direction(minus(v.position, threat))), v.velocity);
}

// Returns the position of a target with constant velocity after the prediction time T = D / max_speed, at most
// `longest`, s. D is the distance of the vehicle from the target's current position `place`, m.
inline Vector predicted(const Vehicle& v, const Vector& place, const Vector& velocity, double longest) {
    const double time = std::min(length(minus(place, v.position)) / v.max_speed, longest);
    return plus(place, times(time, velocity));
}

// Seek, and flee from, the predicted position of a moving quarry or pursuer.
inline Vector pursuit(const Vehicle& v, const Vector& quarry, const Vector& quarry_velocity, double longest) {
    return seek(v, predicted(v, quarry, quarry_velocity, longest));
}
inline Vector evasion(const Vehicle& v, const Vector& pursuer, const Vector& pursuer_velocity, double longest) {
    return flee(v, predicted(v, pursuer, pursuer_velocity, longest));
}

// Seek that slows down within `slowing_distance`, m, and stops at the target.
inline Vector arrival(const Vehicle& v, const Vector& target, double slowing_distance) {
    const Vector way = minus(target, v.position);
    const double distance = length(way);
    const double speed = std::min(v.max_speed * distance / slowing_distance, v.max_speed);
    return minus(times(speed, direction(way)), v.velocity);
}

}  // namespace wade::behaviours
