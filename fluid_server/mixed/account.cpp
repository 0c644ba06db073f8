#include "fluid_server/mixed/account.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene/channel.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/particle_volume.hpp"

namespace wade::fluid::mixed {

namespace {

constexpr double largest_change = 0.1;  // of a cell's depth at once

// Sum of h over cells, m.
double depths_of(const shallow_water::ShallowWater& world, std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t k = 0; k < world.grid.nz; ++k) {
        const std::size_t row = world.grid.row(static_cast<std::ptrdiff_t>(k));
        for (std::size_t i = begin; i < end; ++i) sum += world.water.h[row + i];
    }
    return sum;
}

}  // namespace

double volume_in_window(const Particles& p, const std::array<End, 2>& ends, double spacing) {
    double sum = 0;
    for (std::size_t i = 0; i < p.count; ++i) sum += share_in_window(static_cast<double>(p.x[i]), ends, spacing);
    return sum * particle_volume(spacing);
}

double volume_of_cells(const shallow_water::ShallowWater& world, std::size_t begin, std::size_t end) {
    return depths_of(world, begin, end) * world.grid.cell_area();
}

bool keeps_momentum(const Scene& scene) {
    const Channel& channel = scene.channel;
    return scene.coupling->two_way && channel.flow == Flow::recirculating && channel.bed_points.empty() &&
           channel.slope == 0 && channel.manning_n == 0 && channel.no_slip.empty() && scene.obstacles.empty();
}

double momentum_in_window(const Particles& p, const std::array<End, 2>& ends, double spacing) {
    double sum = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        sum += share_in_window(static_cast<double>(p.x[i]), ends, spacing) * static_cast<double>(p.vx[i]);
    }
    return sum * particle_volume(spacing);
}

double momentum_of_cells(const shallow_water::ShallowWater& world, std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t k = 0; k < world.grid.nz; ++k) {
        const std::size_t row = world.grid.row(static_cast<std::ptrdiff_t>(k));
        for (std::size_t i = begin; i < end; ++i) sum += world.water.qx[row + i];
    }
    return sum * world.grid.cell_area();
}

bool add_momentum_to_cells(shallow_water::ShallowWater& world, std::size_t begin, std::size_t end, double amount) {
    const double volume = volume_of_cells(world, begin, end);
    if (volume <= 0) return false;
    for (std::size_t k = 0; k < world.grid.nz; ++k) {
        const std::size_t row = world.grid.row(static_cast<std::ptrdiff_t>(k));
        for (std::size_t i = begin; i < end; ++i) world.water.qx[row + i] += amount / volume * world.water.h[row + i];
    }
    return true;
}

double add_to_cells(shallow_water::ShallowWater& world, std::size_t begin, std::size_t end, double wanted) {
    const double before = depths_of(world, begin, end);
    if (before <= 0) return 0;
    const double area = world.grid.cell_area();
    const double factor = 1 + std::clamp(wanted / (before * area), -largest_change, largest_change);
    for (std::size_t k = 0; k < world.grid.nz; ++k) {
        const std::size_t row = world.grid.row(static_cast<std::ptrdiff_t>(k));
        for (std::size_t i = begin; i < end; ++i) {
            world.water.h[row + i] *= factor;
            world.water.qx[row + i] *= factor;
            world.water.qz[row + i] *= factor;
        }
    }
    return (depths_of(world, begin, end) - before) * area;
}

}  // namespace wade::fluid::mixed
