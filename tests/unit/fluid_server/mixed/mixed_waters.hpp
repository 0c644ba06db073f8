#pragma once
// Scenes for tests of the mixed model, and measures across the border of the window.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "fluid_server/mixed/mixed_world.hpp"
#include "fluid_server/mixed/model.hpp"

namespace wade::fluid::mixed {

// Four layers of particles in water 1 m deep, 6 m wide, on cells of 0.5 m; the window from x_min to x_max.
inline Scene channel(double length, double x_min, double x_max, Flow flow) {
    Scene scene;
    scene.world->length = length, scene.world->width = 6;
    scene.channel->x = {0, length}, scene.channel->z = {0, 6};
    scene.channel->flow = flow;
    scene.channel->depth = 1;
    scene.fluid->model = wade::ModelKind::mixed;
    scene.fluid->shallow_water.cell_size = 0.5;
    scene.fluid->particle_spacing = 0.25;
    scene.fluid->max_particles = 20000;
    scene.fluid->kinematic_viscosity = 0.01;
    scene.fluid->cfl = 0.5;
    scene.fluid->density_solve = {5e-4, 2, 100};
    scene.fluid->divergence_solve = {1e-3, 1, 100};
    if (x_min < x_max) scene.fluid->mixed.x_min = x_min, scene.fluid->mixed.x_max = x_max;
    return scene;
}

inline Scene basin(double length, double x_min, double x_max, double depth = 1) {
    Scene scene = channel(length, x_min, x_max, Flow::closed);
    scene.channel->water_blocks = {{{0, length}, {0, 6}, depth}};
    return scene;
}

inline Scene river(double length, double x_min, double x_max, double velocity) {
    Scene scene = channel(length, x_min, x_max, Flow::recirculating);
    scene.channel->initial_river = InitialRiver::filled;
    scene.channel->velocity = velocity;
    return scene;
}

inline void run(MixedWorld& world, double time) {
    constexpr double frame = 1.0 / 30;
    for (double t = 0; t < time - 1e-9; t += frame) {
        for (double left = frame; left > 1e-9 * frame;) left -= world.step(left).dt;
    }
}

// Means over the width between two positions along x: of particles in the window, of cells elsewhere.
struct Section {
    double depth = 0;  // volume over area, m
    double speed = 0;  // towards -x, m/s
};
inline Section section(const MixedWorld& world, double from, double to) {
    const shallow_water::ShallowWater& shallow = world.grid_water();
    const shallow_water::Grid& grid = shallow.grid;
    double volume = 0, flow = 0;
    const double particle = std::pow(shallow.scene.fluid->particle_spacing, 3);
    const auto part = [&](double lo, double hi) { return std::max(0.0, std::min(hi, to) - std::max(lo, from)); };
    for (std::size_t k = 0; k < grid.nz; ++k) {
        for (std::size_t i = 0; i < grid.nx; ++i) {
            if (world.window().holds(i)) continue;
            const std::size_t c = grid.row(static_cast<std::ptrdiff_t>(k)) + i;
            const double area = part(grid.face_x(i), grid.face_x(i + 1)) * grid.dz;
            volume += area * shallow.water.h[c];
            flow -= area * shallow.water.qx[c];
        }
    }
    const Particles& p = world.particle_water().particles();
    const double d = shallow.scene.fluid->particle_spacing;
    // A particle is as long as the spacing; what of it lies outside the window is the grid's.
    const double lo = std::max(from, world.ends()[0].x), hi = std::min(to, world.ends()[1].x);
    for (std::size_t i = 0; i < p.count && !world.window().empty(); ++i) {
        const double x = static_cast<double>(p.x[i]);
        const double share = std::max(0.0, std::min(hi, x + 0.5 * d) - std::max(lo, x - 0.5 * d)) / d;
        volume += particle * share;
        flow -= particle * share * static_cast<double>(p.vx[i]);
    }
    return {volume / ((to - from) * grid.z.length()), flow / volume};
}

inline double root_mean_square_speed(const Particles& p) {
    double sum = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        const auto square = [](float v) { return static_cast<double>(v) * static_cast<double>(v); };
        sum += square(p.vx[i]) + square(p.vy[i]) + square(p.vz[i]);
    }
    return std::sqrt(sum / static_cast<double>(p.count));
}

}  // namespace wade::fluid::mixed
