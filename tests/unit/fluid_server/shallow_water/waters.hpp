#pragma once
// Scenes for tests of the shallow-water model, and sums over its grid.

#include <cmath>
#include <cstddef>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "fluid_server/shallow_water/step.hpp"

namespace wade::fluid::shallow_water {

// A closed channel of the length and width with a level bed and no water.
inline Scene basin(double length, double width, double cell) {
    Scene scene;
    scene.world->length = length, scene.world->width = width;
    scene.channel->x = {0, length}, scene.channel->z = {0, width};
    scene.channel->flow = Flow::closed;
    scene.fluid->model = wade::ModelKind::shallow_water;
    scene.fluid->shallow_water.cell_size = cell;
    scene.fluid->particle_spacing = 0.4642;
    scene.fluid->cfl = 0.5;
    return scene;
}

// Periodic along x, filled to the depth.
inline Scene river(double length, double width, double cell, double depth, double velocity) {
    Scene scene = basin(length, width, cell);
    scene.channel->flow = Flow::periodic;
    scene.channel->initial_river = InitialRiver::filled;
    scene.channel->depth = depth, scene.channel->velocity = velocity;
    return scene;
}

inline void run_until(ShallowWater& world, double time) {
    const double begin = world.time;
    double remaining = time - begin;
    while (remaining > 1e-9 * (time - begin)) remaining -= step(world, remaining).dt;
}

// Calls body(x, z, cell) with the centre of each cell.
template <typename Body>
void for_each_cell(const Grid& grid, Body&& body) {
    for (std::size_t k = 0; k < grid.nz; ++k) {
        for (std::size_t i = 0; i < grid.nx; ++i) {
            body(grid.x.lo + (static_cast<double>(i) + 0.5) * grid.dx,
                 grid.z.lo + (static_cast<double>(k) + 0.5) * grid.dz, grid.row(static_cast<std::ptrdiff_t>(k)) + i);
        }
    }
}

inline double volume(const ShallowWater& world) {
    double sum = 0;
    for_each_cell(world.grid, [&](double, double, std::size_t c) { sum += world.water.h[c]; });
    return sum * world.grid.cell_area();
}

}  // namespace wade::fluid::shallow_water
