#pragma once
// Velocity of a stream over its height, with a given mean over the depth.

#include "configs/scene/scene.hpp"

namespace wade::fluid {

struct ProfiledStream {
    VelocityProfile profile = VelocityProfile::uniform;
    double depth = 1;               // m, above 0
    double mean_velocity = 0;       // m/s
    double roughness_length = 0.0;  // z_0, m, above 0 for the logarithmic profile
};

// At the height y in [0, depth], m/s. The logarithmic profile is U ln(1 + y/z_0) / ((1 + z_0/H) ln(1 + H/z_0) - 1):
// the law of the wall, shifted by z_0 so that it is 0 on the bed.
[[nodiscard]] double velocity_at(const ProfiledStream& stream, double y);

// Mean over the heights [bottom, top] within the depth, m/s; bottom < top.
[[nodiscard]] double mean_velocity_between(const ProfiledStream& stream, double bottom, double top);

}  // namespace wade::fluid
