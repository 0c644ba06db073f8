#pragma once
// How the shallow-water model divides the channel.

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "configs/scene/scene.hpp"

namespace wade {

// Cells along an extent: it over the wanted size, rounded, and at least one.
[[nodiscard]] inline std::size_t cells_along(const Interval& extent, double size) {
    return static_cast<std::size_t>(std::max(1L, std::lround(extent.length() / size)));
}

}  // namespace wade
