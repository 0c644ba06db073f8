#pragma once
// Values that are drawn: normal ones within limits, uniform ones.

#include "configs/numbers/portable.hpp"

namespace wade {

// Returns the quantile u, in [0, 1], of the normal distribution with `mean` and `sd` truncated to [lo, hi]. By
// bisection: the cumulative fraction rises, and 80 halvings leave no interval.
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

// One value for all agents of a group, or limits for a value drawn for each agent: uniformly, or normally with the mean
// and the standard deviation that the values would have without limits.
struct Spread {
    double lo = 0;
    double hi = 0;
    double mean = 0;
    double sd = 0;  // 0: uniform

    Spread() = default;
    Spread(double value) : lo(value), hi(value) {}  // NOLINT(google-explicit-constructor): a number is one, too
    Spread(double its_lo, double its_hi) : lo(its_lo), hi(its_hi) {}
    Spread(double its_lo, double its_hi, double its_mean, double its_sd)
        : lo(its_lo), hi(its_hi), mean(its_mean), sd(its_sd) {}

    // The value for a random number u in [0, 1).
    [[nodiscard]] double at(double u) const {
        if (lo < hi && sd > 0) return normal_within(lo, hi, mean, sd, u);
        return lo < hi ? lo + (hi - lo) * u : lo;
    }
    friend bool operator==(const Spread& spread, double value) { return spread.lo == value && spread.hi == value; }
};

}  // namespace wade
