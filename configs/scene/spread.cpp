#include <cmath>
#include <numbers>

#include "configs/scene/scene.hpp"

namespace wade {
namespace {

// Share of the normal values below z standard deviations.
double normal_share(double z) {
    return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

}  // namespace

// The z whose share lies where u does between those of the limits. Bisection: the shares rise, and 80 halvings leave nothing.
double Spread::normal_at(double u) const {
    double z_lo = (lo - mean) / sd, z_hi = (hi - mean) / sd;
    const double from = normal_share(z_lo), share = from + u * (normal_share(z_hi) - from);
    for (int i = 0; i < 80; ++i) {
        const double middle = 0.5 * (z_lo + z_hi);
        (normal_share(middle) < share ? z_lo : z_hi) = middle;
    }
    const double value = mean + 0.5 * (z_lo + z_hi) * sd;
    return value < lo ? lo : value > hi ? hi : value;
}

}  // namespace wade
