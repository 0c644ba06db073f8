#include "fluid_server/kinematic/velocity_profile.hpp"

#include <cmath>

namespace wade::fluid {

namespace {

// Integral of ln(1 + y/z_0) from 0 to y.
double integral(double y, double roughness_length) {
    return (y + roughness_length) * std::log1p(y / roughness_length) - y;
}

}  // namespace

double velocity_at(const ProfiledStream& s, double y) {
    if (s.profile == VelocityProfile::uniform) return s.mean_velocity;
    return s.mean_velocity * s.depth * std::log1p(y / s.roughness_length) / integral(s.depth, s.roughness_length);
}

double mean_velocity_between(const ProfiledStream& s, double bottom, double top) {
    if (s.profile == VelocityProfile::uniform) return s.mean_velocity;
    const double share = (integral(top, s.roughness_length) - integral(bottom, s.roughness_length)) /
                         integral(s.depth, s.roughness_length);
    return s.mean_velocity * share * s.depth / (top - bottom);
}

}  // namespace wade::fluid
