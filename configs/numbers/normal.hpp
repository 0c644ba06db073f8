#pragma once
// Normal values within limits.

#include <cmath>
#include <numbers>

namespace wade {

// Share of the normal values below z standard deviations.
[[nodiscard]] inline double normal_share(double z) {
    return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

// The value of [lo, hi] below which the share u of the normal values within these limits lies, u in [0, 1]. Bisection: the
// shares rise, and 80 halvings leave nothing.
[[nodiscard]] inline double normal_within(double lo, double hi, double mean, double sd, double u) {
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
