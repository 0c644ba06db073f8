#include "fluid_server/dfsph/bed_friction.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene/intervals.hpp"
#include "configs/scene/particle_volume.hpp"
#include "fluid_server/particles/filling.hpp"
#include "fluid_server/particles/parallel.hpp"

namespace wade::fluid {

namespace {

// Width of a column in spacings: with four, one particle more or less in a column changes its depth by a sixteenth of a
// spacing only.
constexpr double width_in_spacings = 4;

// A column with less ground than this share of its cell is taken to stand on the whole cell.
constexpr double least_ground = 0.05;

std::uint32_t columns_along(const Interval& extent, double spacing) {
    return static_cast<std::uint32_t>(std::max(1.0, std::floor(extent.length() / (width_in_spacings * spacing))));
}

}  // namespace

BedFriction::BedFriction(const Scene& scene, bool whole_columns)
    : whole_columns_(whole_columns),
      coefficient_(scene.world.gravity * scene.channel.manning_n * scene.channel.manning_n),
      particle_volume_(particle_volume(scene.fluid)),
      least_depth_(0.5 * scene.fluid.particle_spacing),
      x_lo_(static_cast<float>(scene.channel.x.lo)),
      z_lo_(static_cast<float>(scene.channel.z.lo)),
      columns_per_m_x_(),
      columns_per_m_z_(),
      nx_(columns_along(scene.channel.x, scene.fluid.particle_spacing)),
      nz_(columns_along(scene.channel.z, scene.fluid.particle_spacing)),
      columns_(static_cast<std::size_t>(nx_) * nz_),
      column_of_(static_cast<std::size_t>(scene.fluid.max_particles)) {
    const Channel& channel = scene.channel;
    const double dx = channel.x.length() / nx_;
    const double dz = channel.z.length() / nz_;
    columns_per_m_x_ = static_cast<float>(1 / dx);
    columns_per_m_z_ = static_cast<float>(1 / dz);
    const double depth = deepest_water(scene);
    for (std::uint32_t k = 0; k < nz_; ++k) {
        for (std::uint32_t i = 0; i < nx_; ++i) {
            const Interval x{channel.x.lo + i * dx, channel.x.lo + (i + 1) * dx};
            const Interval z{channel.z.lo + k * dz, channel.z.lo + (k + 1) * dz};
            double ground = dx * dz;
            for (const Obstacle& obstacle : scene.obstacles) {
                if (obstacle.height >= depth) {
                    ground -= common_length(x, obstacle.x) * common_length(z, obstacle.z);
                }
            }
            ground_.push_back(ground > least_ground * dx * dz ? ground : dx * dz);
        }
    }
}

std::uint32_t BedFriction::column_at(float x, float z) const {
    const auto along = [](float place, std::uint32_t n) {
        return static_cast<std::uint32_t>(std::clamp(place, 0.0F, static_cast<float>(n - 1)));
    };
    return along((z - z_lo_) * columns_per_m_z_, nz_) * nx_ + along((x - x_lo_) * columns_per_m_x_, nx_);
}

void BedFriction::sum_columns(const Particles& p) {
    for_each_particle(p.count, [&](std::size_t i) { column_of_[i] = column_at(p.x[i], p.z[i]); });
    std::fill(columns_.begin(), columns_.end(), Column{});
    // One thread, in the order of the particles: the same sums for any number of threads, and a small part of a step.
    for (std::size_t i = 0; i < p.count; ++i) {
        if (whole_columns_ || p.kind[i] == Kind::fluid) {
            Column& column = columns_[column_of_[i]];
            column.particles += 1;
            column.vx += static_cast<double>(p.vx[i]);
            column.vz += static_cast<double>(p.vz[i]);
        }
    }
}

void BedFriction::apply(Particles& p, float dt) {
    sum_columns(p);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
        Column& column = columns_[c];
        if (column.particles > 0) {
            const double depth = std::max(column.particles * particle_volume_ / ground_[c], least_depth_);
            const double speed = std::hypot(column.vx, column.vz) / column.particles;
            const double k = coefficient_ * speed / std::pow(depth, 4.0 / 3);
            column.factor = static_cast<float>(1 / (1 + static_cast<double>(dt) * k));
        }
    }
    for_each_particle(p.count, [&](std::size_t i) {
        if (p.kind[i] == Kind::fluid) {
            const float factor = columns_[column_of_[i]].factor;
            p.vx[i] *= factor;
            p.vz[i] *= factor;
        }
    });
}

}  // namespace wade::fluid
