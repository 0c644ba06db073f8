#pragma once
// Velocity of a stream over its height, with a given mean over the depth.

#include <cmath>

#include "configs/scene/fluid.hpp"
#include "configs/scene/scene.hpp"

namespace wade::fluid {

struct ProfiledStream {
    VelocityProfile profile = VelocityProfile::uniform;
    double depth = 1;               // m, above 0
    double mean_velocity = 0;       // m/s
    double roughness_length = 0.0;  // z_0, m, above 0 for the logarithmic profile
};

// Integral of ln(1 + y/z_0) from 0 to y.
[[nodiscard]] inline double log_profile_integral(double y, double roughness_length) {
    return (y + roughness_length) * std::log1p(y / roughness_length) - y;
}

// At the height y in [0, depth], m/s. The logarithmic profile is U ln(1 + y/z_0) / ((1 + z_0/H) ln(1 + H/z_0) - 1):
// the law of the wall, shifted by z_0 so that it is 0 on the bed.
[[nodiscard]] inline double velocity_at(const ProfiledStream& s, double y) {
    if (s.profile == VelocityProfile::uniform) return s.mean_velocity;
    return s.mean_velocity * s.depth * std::log1p(y / s.roughness_length) /
           log_profile_integral(s.depth, s.roughness_length);
}

// Mean over the heights [bottom, top] within the depth, m/s; bottom < top.
[[nodiscard]] inline double mean_velocity_between(const ProfiledStream& s, double bottom, double top) {
    if (s.profile == VelocityProfile::uniform) return s.mean_velocity;
    const double share =
        (log_profile_integral(top, s.roughness_length) - log_profile_integral(bottom, s.roughness_length)) /
        log_profile_integral(s.depth, s.roughness_length);
    return s.mean_velocity * share * s.depth / (top - bottom);
}

}  // namespace wade::fluid
