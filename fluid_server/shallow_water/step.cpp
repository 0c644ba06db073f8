#include "fluid_server/shallow_water/step.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "fluid_server/particles/filling.hpp"
#include "fluid_server/particles/inflow.hpp"
#include "fluid_server/shallow_water/row_update.hpp"

namespace wade::fluid::shallow_water {

namespace {

// With fewer cells than this the threads would wait for one another longer than they work.
constexpr std::size_t serial_below = 4096;

// A cell is dry below this share of the deepest water: a film without velocity.
constexpr double dry_share = 1e-5;

// A step of 1/1000 that still empties a cell too far is taken.
constexpr int most_halvings = 10;

// `step`: from a cell to the one above the face.
Walls find_walls(const Grid& grid, const RowMemory& obstacle, std::size_t step) {
    Walls walls;
    if (obstacle.empty()) return walls;
    walls.side.assign(grid.stored(), 0);
    walls.rows.assign(grid.stored() / grid.stride, 0);
    for (std::size_t c = step; c < grid.stored(); ++c) {
        walls.side[c] = obstacle[c] - obstacle[c - step];
        if (walls.side[c] != 0) walls.rows[c / grid.stride] = 1;
    }
    return walls;
}

double sum(const std::vector<double>& values) {
    double total = 0;
    for (const double value : values) total += value;
    return total;
}

// Calls body(first row, end row, buffer) for a band of rows in each thread.
template <typename Body>
void for_each_band(ShallowWater& world, Body&& body) {
    const Grid& grid = world.grid;
    const bool parallel = grid.cells() >= serial_below;
    world.buffers.resize(static_cast<std::size_t>(parallel ? omp_get_max_threads() : 1));
#pragma omp parallel if (parallel)
    {
        const auto threads = static_cast<std::size_t>(parallel ? omp_get_num_threads() : 1);
        const auto thread = static_cast<std::size_t>(parallel ? omp_get_thread_num() : 0);
        body(thread * grid.nz / threads, (thread + 1) * grid.nz / threads, world.buffers[thread]);
    }
}

// One Euler step, mixed with the world's `water`: see update_band().
void euler_step(ShallowWater& world, const BandFrom& from, double share, double dt, double discharge,
                const BandTo& to) {
    const StageTerms terms{world.constants, world.acceleration, world.scene.channel.manning_n, share, dt, discharge};
    for_each_band(world, [&](std::size_t begin, std::size_t end, RowMemory& buffer) {
        update_band(world, from, terms, begin, end, buffer, to);
    });
    fill_ghosts(to.primitive, world.grid, world.scene.channel, world.constants.gravity);
}

double time_step(ShallowWater& world, double remaining) {
    const Grid& grid = world.grid;
    for_each_band(world, [&](std::size_t begin, std::size_t end, RowMemory&) {
        for (std::size_t k = begin; k < end; ++k) {
            const std::size_t c = grid.row(static_cast<std::ptrdiff_t>(k));
            world.row_fastest[k] = fastest_of_row(
                {world.primitive.h.data() + c, nullptr, world.primitive.u.data() + c, world.primitive.v.data() + c},
                grid.nx, world.constants.gravity, 1 / grid.dx, 1 / grid.dz);
        }
    });
    double rate = 0;
    for (const double fastest : world.row_fastest) {
        if (!(fastest < 1e300)) {
            throw RunError(ExitCode::numerical_failure, "the shallow water is not finite; lower /fluid/cfl");
        }
        rate = std::max(rate, fastest);
    }
    const Channel& channel = world.scene.channel;
    if (channel.flow == Flow::emitter) {
        const double v = largest_velocity(channel, world.time, world.time + remaining);
        rate = std::max(rate, (v + std::sqrt(world.constants.gravity * channel.depth)) / grid.dx);
    }
    const double longest = rate > 0 ? world.scene.fluid.cfl / rate : remaining;
    return remaining / std::ceil(std::max(1.0, remaining / longest));
}

bool stayed_positive(const ShallowWater& world) {
    const double rounding = -1e-10 * world.constants.dry;
    return *std::min_element(world.row_least.begin(), world.row_least.end()) >= rounding;
}

// Heun's step of report.dt from `water` to `stage`; `primitive` is that of `water` before and that of `stage` after it.
// Whether all depths stayed positive.
bool heun_step(ShallowWater& world, StepReport& report) {
    const Channel& channel = world.scene.channel;
    const double discharge =
        channel.flow == Flow::emitter ? channel.depth * mean_velocity(channel, world.time, world.time + report.dt) : 0;
    const auto note_flow = [&] {
        report.inflow -= 0.5 * report.dt * world.grid.dz * sum(world.row_inflow);
        report.outflow -= 0.5 * report.dt * world.grid.dz * sum(world.row_outflow);
        for (WatchedFace& watched : world.watched) {
            watched.step_volume += 0.5 * report.dt * world.grid.dz * sum(watched.row_mass);
            watched.step_momentum += 0.5 * report.dt * world.grid.dz * sum(watched.row_momentum);
        }
    };
    for (WatchedFace& watched : world.watched) watched.step_volume = watched.step_momentum = 0;
    Water &water = world.water, &stage = world.stage;
    euler_step(world, {water.qx, water.qz, world.primitive}, 1, report.dt, discharge,
               {nullptr, stage.qx, stage.qz, world.stage_primitive});
    note_flow();
    const bool positive = stayed_positive(world);
    euler_step(world, {stage.qx, stage.qz, world.stage_primitive}, 0.5, report.dt, discharge,
               {&stage.h, stage.qx, stage.qz, world.primitive});
    note_flow();
    return positive && stayed_positive(world);
}

// Gives all water the velocity along x that it lacks to v_F; returns the acceleration towards -x.
double drive(ShallowWater& world, double dt) {
    const Grid& grid = world.grid;
    for_each_band(world, [&](std::size_t begin, std::size_t end, RowMemory&) {
        for (std::size_t k = begin; k < end; ++k) {
            const std::size_t c = grid.row(static_cast<std::ptrdiff_t>(k));
            world.row_volume[k] = sum_of_row(world.water.h.data() + c, grid.nx);
            world.row_momentum[k] = sum_of_row(world.water.qx.data() + c, grid.nx);
        }
    });
    const double volume = sum(world.row_volume);
    if (volume <= 0) return 0;
    const double lack = -velocity_at(world.scene.channel, world.time + dt) - sum(world.row_momentum) / volume;
    for_each_band(world, [&](std::size_t begin, std::size_t end, RowMemory&) {
        for (std::size_t k = begin; k < end; ++k) {
            const std::size_t c = grid.row(static_cast<std::ptrdiff_t>(k));
            for (std::size_t i = c; i < c + grid.nx; ++i) world.water.qx[i] += lack * world.water.h[i];
        }
    });
    return -lack / dt;
}

}  // namespace

ShallowWater::ShallowWater(const Scene& its_scene)
    : scene(its_scene),
      grid(make_grid(scene)),
      bed(make_bed(scene, grid)),
      water(initial_water(scene, grid, bed)),
      primitive(grid, bed),
      stage(grid),
      stage_primitive(grid, bed),
      walls_x(find_walls(grid, bed.obstacle, 1)),
      walls_z(find_walls(grid, bed.obstacle, grid.stride)),
      row_fastest(grid.nz, 0),
      row_least(grid.nz, 0),
      row_volume(grid.nz, 0),
      row_momentum(grid.nz, 0),
      row_inflow(grid.nz, 0),
      row_outflow(grid.nz, 0) {
    const double tilt = std::atan(scene.channel.slope);
    constants.gravity = scene.world.gravity * std::cos(tilt);
    constants.dry = dry_share * deepest_water(scene);
    acceleration = -scene.world.gravity * std::sin(tilt);
    update_primitive(*this);
}

void watch_faces(ShallowWater& world, const std::vector<std::size_t>& faces) {
    world.watched.clear();
    for (const std::size_t face : faces) {
        WatchedFace& watched = world.watched.emplace_back();
        watched.face = face;
        watched.row_mass.assign(world.grid.nz, 0);
        watched.row_momentum.assign(world.grid.nz, 0);
    }
}

void update_primitive(ShallowWater& world) {
    const Water& water = world.water;
    for_each_band(world, [&](std::size_t begin, std::size_t end, RowMemory&) {
        for (std::size_t k = begin; k < end; ++k) {
            const std::size_t c = world.grid.row(static_cast<std::ptrdiff_t>(k));
            Primitive& p = world.primitive;
            double* const eta = p.eta.empty() ? p.h.data() : p.eta.data();
            find_primitive(water.h.data() + c, water.qx.data() + c, water.qz.data() + c, world.bed.height.data() + c,
                           world.grid.nx, world.constants.dry,
                           {p.h.data() + c, eta + c, p.u.data() + c, p.v.data() + c});
        }
    });
    fill_ghosts(world.primitive, world.grid, world.scene.channel, world.constants.gravity);
}

StepReport step(ShallowWater& world, double remaining) {
    StepReport report;
    report.dt = time_step(world, remaining);
    for (int halved = 0; !heun_step(world, report) && halved < most_halvings; ++halved) {
        update_primitive(world);
        report = {0.5 * report.dt, 0, 0, 0};
    }
    std::swap(world.water, world.stage);
    for (WatchedFace& watched : world.watched) {
        watched.volume += watched.step_volume;
        watched.momentum += watched.step_momentum;
    }
    if (world.scene.channel.flow == Flow::recirculating) {
        report.driving_acceleration = drive(world, report.dt);
        update_primitive(world);
    }
    world.time += report.dt;
    return report;
}

}  // namespace wade::fluid::shallow_water
