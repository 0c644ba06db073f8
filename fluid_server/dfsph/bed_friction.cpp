#include "fluid_server/dfsph/bed_friction.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "configs/numbers/portable.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/intervals.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/particle_volume.hpp"
#include "configs/scene/world.hpp"
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

// Returns the area of the houses of a site by column, m2; overlaps count as often. columns: their number along x.
void take_houses(const Site& site, const Interval& x, const Interval& z, std::uint32_t nx, std::uint32_t nz,
                 std::vector<double>& ground) {
    constexpr int along = 4;  // sample points along each side of a column, to find houses
    const double dx = x.length() / nx, dz = z.length() / nz, part = dx * dz / (along * along);
    const auto columns = [](double lo, double hi, double begin, double width, std::uint32_t n) {
        const auto at = [&](double v) {
            return static_cast<std::uint32_t>(std::clamp(std::floor((v - begin) / width), 0.0, static_cast<double>(n)));
        };
        return std::array<std::uint32_t, 2>{at(lo), std::min(n, at(hi) + 1)};
    };
    for (const House& house : site.houses) {
        Interval over_x{INFINITY, -INFINITY}, over_z{INFINITY, -INFINITY};
        for (const MapLine& ring : house.polygon.rings) {
            for (const MapPoint& p : ring) {
                over_x = {std::min(over_x.lo, p.x), std::max(over_x.hi, p.x)};
                over_z = {std::min(over_z.lo, p.z), std::max(over_z.hi, p.z)};
            }
        }
        const auto [first, behind] = columns(over_x.lo, over_x.hi, x.lo, dx, nx);
        const auto [first_row, last_row] = columns(over_z.lo, over_z.hi, z.lo, dz, nz);
        for (std::uint32_t k = first_row; k < last_row; ++k) {
            for (std::uint32_t i = first; i < behind; ++i) {
                for (int n = 0; n < along * along; ++n) {
                    const int part_x = n % along, part_z = n / along;
                    const MapPoint p{x.lo + (i + (part_x + 0.5) / along) * dx,
                                     z.lo + (k + (part_z + 0.5) / along) * dz};
                    if (contains(house.polygon, p)) ground[k * nx + i] -= part;
                }
            }
        }
    }
}

double manning_at(const Roughness& roughness, const MapPoint& p) {
    double n = roughness.raster ? height_in(*roughness.raster, p) : roughness.n;
    for (const ManningZone& zone : roughness.zones) {
        if (contains(zone.polygon, p)) n = zone.n;
    }
    return n;
}

}  // namespace

WaterColumns::WaterColumns(const Scene& scene, bool whole_columns)
    : whole_columns_(whole_columns),
      particle_volume_(particle_volume(scene.fluid)),
      x_(scene.channel->x),
      z_(scene.channel->z),
      columns_per_m_x_(),
      columns_per_m_z_(),
      nx_(columns_along(scene.channel->x, scene.fluid->particle_spacing)),
      nz_(columns_along(scene.channel->z, scene.fluid->particle_spacing)),
      columns_(static_cast<std::size_t>(nx_) * nz_),
      column_of_(static_cast<std::size_t>(scene.fluid->max_particles)) {
    find_ground(scene);
}

void WaterColumns::find_ground(const Scene& scene) {
    const double dx = x_.length() / nx_;
    const double dz = z_.length() / nz_;
    columns_per_m_x_ = static_cast<float>(1 / dx);
    columns_per_m_z_ = static_cast<float>(1 / dz);
    const double depth = deepest_water(scene);
    for (std::uint32_t k = 0; k < nz_; ++k) {
        for (std::uint32_t i = 0; i < nx_; ++i) {
            const Interval x{x_.lo + i * dx, x_.lo + (i + 1) * dx};
            const Interval z{z_.lo + k * dz, z_.lo + (k + 1) * dz};
            double ground = dx * dz;
            for (const Obstacle& obstacle : scene.obstacles) {
                if (obstacle.height >= depth) {
                    ground -= common_length(x, obstacle.x) * common_length(z, obstacle.z);
                }
            }
            ground_.push_back(ground);
        }
    }
    if (scene.site) take_houses(*scene.site, x_, z_, nx_, nz_, ground_);
    for (double& ground : ground_) {
        solid_.push_back(!(ground > least_ground * dx * dz));
        if (solid_.back()) ground = dx * dz;
    }
}

std::uint32_t WaterColumns::column_at(float px, float pz) const {
    const auto along = [](float place, std::uint32_t n) {
        return static_cast<std::uint32_t>(std::clamp(place, 0.0F, static_cast<float>(n - 1)));
    };
    return along((pz - static_cast<float>(z_.lo)) * columns_per_m_z_, nz_) * nx_ +
           along((px - static_cast<float>(x_.lo)) * columns_per_m_x_, nx_);
}

void WaterColumns::sum(const Particles& p) {
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

MapPoint WaterColumns::middle(std::size_t c) const {
    const std::size_t column = c % nx_, row = c / nx_;
    return {x_.lo + (static_cast<double>(column) + 0.5) * x_.length() / nx_,
            z_.lo + (static_cast<double>(row) + 0.5) * z_.length() / nz_};
}

double WaterColumns::depth(std::size_t c) const {
    return columns_[c].particles * particle_volume_ / ground_[c];
}

double WaterColumns::speed(std::size_t c) const {
    return length_of(columns_[c].vx, columns_[c].vz) / columns_[c].particles;
}

bool is_rough(const Scene& scene) {
    if (!scene.site) return scene.channel->manning_n > 0;
    const Roughness& roughness = scene.site->roughness;
    return roughness.n > 0 || roughness.raster || !roughness.zones.empty();
}

BedFriction::BedFriction(const Scene& scene, bool whole_columns)
    : columns_(scene, whole_columns),
      least_depth_(0.5 * scene.fluid->particle_spacing),
      factor_(columns_.count(), 1.0F) {
    for (std::size_t c = 0; c < columns_.count(); ++c) {
        const double n = scene.site ? manning_at(scene.site->roughness, columns_.middle(c)) : scene.channel->manning_n;
        coefficient_.push_back(scene.world->gravity * n * n);
    }
}

void BedFriction::apply(Particles& p, float dt) {
    columns_.sum(p);
    for (std::size_t c = 0; c < columns_.count(); ++c) {
        if (!columns_.is_wet(c)) continue;
        const double depth = std::max(columns_.depth(c), least_depth_);
        const double k = coefficient_[c] * columns_.speed(c) / std::pow(depth, 4.0 / 3);
        factor_[c] = static_cast<float>(1 / (1 + static_cast<double>(dt) * k));
    }
    for_each_particle(p.count, [&](std::size_t i) {
        if (p.kind[i] == Kind::fluid) {
            const float factor = factor_[columns_.of(i)];
            p.vx[i] *= factor;
            p.vz[i] *= factor;
        }
    });
}

}  // namespace wade::fluid
