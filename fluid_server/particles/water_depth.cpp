#include "fluid_server/particles/water_depth.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/particle_volume.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "fluid_server/particles/filling.hpp"

namespace wade::fluid {

namespace {

// Threshold in multiples of the depth of the scene's water. A trial with 1.25 kept the jump up as well; with 2 nothing
// changes in scenes with water near that depth.
constexpr double piled_up = 2;
constexpr double few_layers = 10;  // up to so many layers their number does not change the solve

std::size_t columns_along(double length, double support_radius) {
    return static_cast<std::size_t>(std::max(1.0, std::floor(length / (2 * support_radius))));
}

}  // namespace

WaterDepth::WaterDepth(const Scene& scene)
    : of_scene_(deepest_water(scene)),
      spacing_(scene.fluid->particle_spacing),
      x_(scene.channel->x),
      z_(scene.channel->z),
      nx_(columns_along(x_.length(), support_radius_of(scene.fluid))),
      nz_(columns_along(z_.length(), support_radius_of(scene.fluid))) {}

double WaterDepth::now(const Particles& particles, double highest) {
    const double much = std::max(piled_up * of_scene_, few_layers * spacing_);
    if (highest <= much) return of_scene_;
    const double deepest = deepest_column(particles);
    return deepest > much ? deepest : of_scene_;
}

double WaterDepth::deepest_column(const Particles& p) {
    particles_in_.assign(nx_ * nz_, 0);
    const double per_x = static_cast<double>(nx_) / x_.length(), per_z = static_cast<double>(nz_) / z_.length();
    for (std::size_t i = 0; i < p.count; ++i) {
        const double a = std::floor((static_cast<double>(p.x[i]) - x_.lo) * per_x);
        const double b = std::floor((static_cast<double>(p.z[i]) - z_.lo) * per_z);
        if (a < 0 || b < 0 || a >= static_cast<double>(nx_) || b >= static_cast<double>(nz_)) continue;
        ++particles_in_[static_cast<std::size_t>(b) * nx_ + static_cast<std::size_t>(a)];
    }
    const std::uint32_t most = *std::max_element(particles_in_.begin(), particles_in_.end());
    return static_cast<double>(most) * particle_volume(spacing_) * per_x * per_z;
}

}  // namespace wade::fluid
