#pragma once
// Lengths of the mixed model that the loader and the water agree on.

#include <algorithm>
#include <cmath>

#include "configs/scene/fluid.hpp"
#include "configs/scene/scene.hpp"
#include "configs/scene/scene_capacity.hpp"

namespace wade {

// Whether only the people can say where the mixed model needs particles.
[[nodiscard]] inline bool mixed_needs_agents(const Scene& scene) {
    const MixedWindow& mixed = scene.fluid->mixed;
    const bool at_obstacles = mixed.obstacles && !scene.obstacles.empty();
    return scene.fluid->model == ModelKind::mixed && !mixed.x_min && !at_obstacles;
}

// Cells that the mean of the particles round the middle of a cell reaches to each side: two spacings, so that it spans four,
// and 0.45 times the depth, as water that is uneven over less does not move as shallow water; whole cells.
[[nodiscard]] inline int cells_of_mean(const Scene& scene, double cell) {
    const double reach = std::max(2 * scene.fluid->particle_spacing, 0.45 * deepest_water(scene));
    return std::max(1, static_cast<int>(std::ceil(reach / cell - 1e-9)));
}

// Length of a guard, m: a support radius, so that particles in the window miss no neighbour, a spacing for what moves within
// a step, no less than the mean reaches, and two thirds of the depth: before guards of eight layers of particles that were a
// third as long as deep the stream sped up until the water failed.
[[nodiscard]] inline double guard_length(const Scene& scene, double cell) {
    const Fluid& fluid = scene.fluid;
    return std::max({support_radius_of(fluid) + fluid.particle_spacing, cells_of_mean(scene, cell) * cell,
                     2.0 / 3 * deepest_water(scene)});
}

}  // namespace wade
