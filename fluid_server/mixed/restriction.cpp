#include "fluid_server/mixed/restriction.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene/channel.hpp"
#include "configs/scene/mixed_window.hpp"
#include "configs/scene/particle_volume.hpp"
#include "fluid_server/particles/filling.hpp"

namespace wade::fluid::mixed {

namespace {

// Calls body(cell, weight) for the cells along one axis with a tent over `place`, in cells from the middle of cell 0.
template <typename Body>
void for_each_tent(double place, std::ptrdiff_t reach, Body&& body) {
    const auto width = static_cast<double>(reach);
    const auto last = static_cast<std::ptrdiff_t>(std::floor(place + width));
    for (auto c = static_cast<std::ptrdiff_t>(std::ceil(place - width)); c <= last; ++c) {
        body(c, 1 - std::abs(static_cast<double>(c) - place) / width);
    }
}

std::ptrdiff_t wrapped(std::ptrdiff_t c, std::size_t n) {
    const auto period = static_cast<std::ptrdiff_t>(n);
    return (c % period + period) % period;
}

}  // namespace

Restriction::Restriction(const shallow_water::ShallowWater& world)
    : reach_(cells_of_mean(world.scene, std::max(world.grid.dx, world.grid.dz))),
      time_(static_cast<double>(reach_) * world.grid.dx /
            std::sqrt(world.constants.gravity * std::max(deepest_water(world.scene), 1e-3))),
      periodic_across_(world.scene.channel->sides == Sides::periodic),
      particle_volume_(particle_volume(world.scene.fluid)),
      area_(world.grid.cells(), 0),
      volume_(world.grid.cells(), 0),
      flow_x_(world.grid.cells(), 0),
      flow_z_(world.grid.cells(), 0) {
    const shallow_water::Grid& grid = world.grid;
    const double top = deepest_water(world.scene);
    const auto is_free = [&](std::ptrdiff_t i, std::ptrdiff_t k) {
        const std::size_t c = grid.row(k) + static_cast<std::size_t>(i);
        return world.bed.obstacle.empty() || world.bed.obstacle[c] < 0.5 || world.bed.height[c] < top;
    };
    const auto nx = static_cast<std::ptrdiff_t>(grid.nx), nz = static_cast<std::ptrdiff_t>(grid.nz);
    // Integral of the tent over the cell `offset` cells from its middle, in cells.
    const auto tent_over_cell = [&](std::ptrdiff_t offset) {
        const auto width = static_cast<double>(reach_), off = std::abs(static_cast<double>(offset));
        if (offset == 0) return 1 - 1 / (4 * width);
        return off < width ? 1 - off / width : 1 / (8 * width);
    };
    for (std::ptrdiff_t k = 0; k < nz; ++k) {
        for (std::ptrdiff_t i = 0; i < nx; ++i) {
            if (!is_free(i, k)) continue;
            double sum = 0;
            for (std::ptrdiff_t kk = k - reach_; kk <= k + reach_; ++kk) {
                if (!periodic_across_ && (kk < 0 || kk >= nz)) continue;
                for (std::ptrdiff_t ii = std::max<std::ptrdiff_t>(i - reach_, 0); ii <= std::min(i + reach_, nx - 1);
                     ++ii) {
                    if (is_free(ii, wrapped(kk, grid.nz))) sum += tent_over_cell(ii - i) * tent_over_cell(kk - k);
                }
            }
            area_[static_cast<std::size_t>(k * nx + i)] = sum * grid.cell_area();
        }
    }
}

void Restriction::add_particles(const shallow_water::ShallowWater& world, const Particles& p, const Window& window) {
    const shallow_water::Grid& grid = world.grid;
    for (std::vector<double>* sums : {&volume_, &flow_x_, &flow_z_}) {
        for (std::size_t k = 0; k < grid.nz; ++k) {
            std::fill(sums->begin() + static_cast<std::ptrdiff_t>(k * grid.nx + window.begin),
                      sums->begin() + static_cast<std::ptrdiff_t>(k * grid.nx + window.end), 0.0);
        }
    }
    const auto begin = static_cast<std::ptrdiff_t>(window.begin), end = static_cast<std::ptrdiff_t>(window.end);
    const auto nz = static_cast<std::ptrdiff_t>(grid.nz);
    // In the order of the particles: the same sums for any number of threads.
    for (std::size_t i = 0; i < p.count; ++i) {
        const double along = (static_cast<double>(p.x[i]) - grid.x.lo) / grid.dx - 0.5;
        const double across = (static_cast<double>(p.z[i]) - grid.z.lo) / grid.dz - 0.5;
        const double vx = static_cast<double>(p.vx[i]), vz = static_cast<double>(p.vz[i]);
        for_each_tent(across, reach_, [&](std::ptrdiff_t k, double wz) {
            if (!periodic_across_ && (k < 0 || k >= nz)) return;
            const std::size_t row = static_cast<std::size_t>(wrapped(k, grid.nz)) * grid.nx;
            for_each_tent(along, reach_, [&](std::ptrdiff_t c, double wx) {
                if (c < begin || c >= end) return;
                const std::size_t cell = row + static_cast<std::size_t>(c);
                volume_[cell] += wx * wz;
                flow_x_[cell] += wx * wz * vx;
                flow_z_[cell] += wx * wz * vz;
            });
        });
    }
}

void Restriction::apply(shallow_water::ShallowWater& world, const Particles& p, const Window& window, double dt) {
    const shallow_water::Grid& grid = world.grid;
    add_particles(world, p, window);
    const double share = -std::expm1(-dt / time_);
    shallow_water::Water& water = world.water;
    for (std::size_t k = 0; k < grid.nz; ++k) {
        const std::size_t row = grid.row(static_cast<std::ptrdiff_t>(k));
        for (std::size_t i = window.begin; i < window.end; ++i) {
            const std::size_t cell = k * grid.nx + i;
            if (area_[cell] <= 0) continue;
            const double per_area = particle_volume_ / area_[cell];
            water.h[row + i] += share * (volume_[cell] * per_area - water.h[row + i]);
            water.qx[row + i] += share * (flow_x_[cell] * per_area - water.qx[row + i]);
            water.qz[row + i] += share * (flow_z_[cell] * per_area - water.qz[row + i]);
        }
    }
}

}  // namespace wade::fluid::mixed
