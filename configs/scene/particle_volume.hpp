#pragma once
// A water particle represents a cube with side d, the spacing.

#include <cmath>
#include <cstdint>

#include "configs/scene/fluid.hpp"
#include "configs/scene/scene.hpp"

namespace wade {

// d^3, m^3. spacing: d, m
[[nodiscard]] constexpr double particle_volume(double spacing) {
    return spacing * spacing * spacing;
}
[[nodiscard]] inline double particle_volume(const Fluid& fluid) {
    return particle_volume(fluid.particle_spacing);
}

// rho_0 d^3, kg.
[[nodiscard]] inline double particle_mass(const Fluid& fluid) {
    return fluid.rest_density * particle_volume(fluid);
}

// How many particles a volume of water, m^3, is, rounded.
[[nodiscard]] inline std::uint64_t particles_in(double volume, double spacing) {
    return static_cast<std::uint64_t>(std::llround(volume / particle_volume(spacing)));
}

}  // namespace wade
