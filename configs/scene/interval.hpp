#pragma once
// An interval of a coordinate.

namespace wade {

struct Interval {
    double lo = 0;
    double hi = 0;
    [[nodiscard]] double length() const { return hi - lo; }
    [[nodiscard]] bool contains(double v) const { return lo <= v && v <= hi; }
};

}  // namespace wade
