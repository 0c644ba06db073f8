#pragma once
// Lengths of the mixed model that the loader and the water agree on.

#include <algorithm>
#include <cmath>

#include "configs/scene.hpp"
#include "configs/scene_capacity.hpp"

namespace wade {

// Cells that the mean of the particles round the middle of a cell reaches to each side: two spacings, so that it spans four,
// and whole cells.
[[nodiscard]] inline int cells_of_mean(const Fluid& fluid, double cell) {
    return std::max(1, static_cast<int>(std::ceil(2 * fluid.particle_spacing / cell - 1e-9)));
}

// Length of a guard, m: a support radius, so that particles in the window miss no neighbour, a spacing for what moves within
// a step, and no less than the mean reaches.
[[nodiscard]] inline double guard_length(const Fluid& fluid, double cell) {
    return std::max(support_radius_of(fluid) + fluid.particle_spacing, cells_of_mean(fluid, cell) * cell);
}

}  // namespace wade
