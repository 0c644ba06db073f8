#pragma once
// What intervals have in common.

#include <algorithm>

#include "configs/scene/scene.hpp"

namespace wade {

// Length of what lies in both, m.
[[nodiscard]] inline double common_length(const Interval& a, const Interval& b) {
    return std::max(0.0, std::min(a.hi, b.hi) - std::max(a.lo, b.lo));
}

}  // namespace wade
