#pragma once
// What intervals have in common.

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "configs/scene/interval.hpp"
#include "configs/scene/scene.hpp"

namespace wade {

// Length of what lies in both, m.
[[nodiscard]] inline double common_length(const Interval& a, const Interval& b) {
    return std::max(0.0, std::min(a.hi, b.hi) - std::max(a.lo, b.lo));
}

// Cells of the shallow-water model along an extent: it over the wanted size, rounded, and at least one.
[[nodiscard]] inline std::size_t cells_along(const Interval& extent, double size) {
    return static_cast<std::size_t>(std::max(1L, std::lround(extent.length() / size)));
}

}  // namespace wade
