#include "fluid_server/shallow_water/model.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "configs/checks/scene_checks.hpp"
#include "configs/errors/exit_code.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/particle_volume.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "configs/scene/world.hpp"
#include "fluid_server/particles/inflow.hpp"

namespace wade::fluid::shallow_water {

// Measured: bytes a cell, and seconds of CPU time a cell and step.
Estimate ShallowWaterModel::estimate(const Scene& scene) {
    const double bytes_of_cell = scene.site ? 290 : 210;
    constexpr double cell_step_cost = 4e-8;
    const Grid grid = make_grid(scene);
    const auto cells = static_cast<double>(grid.cells());
    const auto room =
        scene.site ? grid.cells() : static_cast<std::uint64_t>(std::max(scene.fluid->max_particles, 0)) + grid.cells();
    Estimate estimate;
    estimate.particles = std::min(particles_expected(scene) + grid.cells(), room);
    const std::size_t field = sizeof(double) * grid.stored(), fields = scene.site ? 21 : 14;  // in pages of their own
    estimate.memory = empty_server + bytes_of_cell * cells +
                      static_cast<double>(fields * (bytes_in_memory(field) - field)) + memory_of_frames(scene, room);
    const double speed = largest_velocity(scene.channel) + std::sqrt(scene.world->gravity * deepest_water(scene));
    const double rate = speed * (1 / grid.dx + 1 / grid.dz) / scene.fluid->cfl;  // steps a second
    estimate.cpu_time = scene.duration * std::max(rate, scene.frame_rate) * cells * cell_step_cost;
    return estimate;
}

void ShallowWaterModel::spread_over(Ranks& ranks) {
    if (world_.scene.coupling->two_way) {
        throw ConfigurationError(world_.scene.name +
                                 ": /coupling/two_way: people do not push water that is spread over "
                                 "ranks; allowed: false");
    }
    spread(world_, ranks);
}

shm::Diagnostics ShallowWaterModel::advance_frame(const FrameInterval& interval) {
    if (Ranks* const ranks = world_.band.ranks; ranks != nullptr && ranks->first()) {
        ranks->tell(std::array{interval.begin_tick, interval.end_tick, interval.ticks_per_second});
    }
    const std::array<RowField, 2> places = particles_.places(world_.grid);
    rebalance(world_, places);
    const auto start = std::chrono::steady_clock::now();
    const double frame_time = interval.duration();
    people_.frame_time = frame_time;
    shm::Diagnostics d;
    double driving = 0;
    double remaining = frame_time;
    // What is left after the last sub-step is rounding.
    while (remaining > 1e-9 * frame_time) {
        StepReport report;
        try {
            report = step(world_, remaining, &people_);
        } catch (const RunError& error) {
            if (error.code() != ExitCode::numerical_failure) throw;
            throw RunError(error.code(),
                           "the water failed at t = " + short_number(world_.time) + " s: " + error.what());
        }
        particles_.drift(world_, report.dt);
        remaining -= report.dt;
        ++d.sub_steps;
        d.last_dt_s = report.dt;
        driving += report.driving_acceleration * report.dt;
        inflow_ += report.inflow;
        outflow_ += report.outflow;
        cell_steps_ += static_cast<double>(active_cells(world_));
    }
    collect_frame(world_, places);
    if (!world_.band.counts()) return d;
    const auto elapsed = std::chrono::steady_clock::now() - start;
    particles_.count(world_);
    d.solver_ns = static_cast<std::uint64_t>(std::chrono::nanoseconds(elapsed).count());
    note_water(world_, driving / frame_time, outflow_, d);
    people_.pushes.clear();
    note_people(people_, d);
    add_to_maps();
    return d;
}

void ShallowWaterModel::begin_maps() {
    if (!world_.scene.site) return;
    at_first_ = measure(world_).volume;
    const Grid& grid = world_.grid;
    maps_.emplace(MapGrid{grid.x.lo, grid.z.lo, grid.dx, grid.dz, grid.nx, grid.nz});
    std::vector<double> ground(grid.cells());
    for (std::size_t k = 0; k < grid.cells(); ++k) {
        const std::size_t c = grid.row(static_cast<std::ptrdiff_t>(k / grid.nx)) + k % grid.nx;
        maps_->wall[k] = world_.openings.share_of(c) < 0.5;
        ground[k] = world_.bed.height[c];
    }
    place_gauges(*maps_, *world_.scene.site, ground);
    for (const GaugeRecord& gauge : maps_->gauges) world_.gauged.push_back({gauge.row, gauge.column});
}

void ShallowWaterModel::add_to_maps() {
    if (!maps_) return;
    for (std::size_t k = 0; k < world_.grid.nz; ++k) {
        const std::size_t c = world_.grid.row(static_cast<std::ptrdiff_t>(k));
        const Primitive& now = world_.primitive;
        add_row(*maps_, k, world_.time, world_.water.h.data() + c, now.u.data() + c, now.v.data() + c);
    }
    for (std::size_t n = 0; n < world_.gauged.size(); ++n) {
        maps_->gauges[n].qx.back() = world_.gauged[n].qx;
        maps_->gauges[n].qz.back() = world_.gauged[n].qz;
    }
}

void ShallowWaterModel::write_results(const std::filesystem::path& folder) const {
    if (maps_) write_maps(*maps_, *world_.scene.site, folder);
}

std::string ShallowWaterModel::remarks() const {
    char text[280];
    if (world_.site) {
        std::snprintf(
            text, sizeof text,
            "grid of %zu x %zu cells of %.4g m x %.4g m, %.4g M steps of cells at the water, %.9g m3 stood there, "
            "%.9g m3 came in, %.9g m3 went out, %.9g m3 are left",
            world_.grid.nx, world_.grid.nz, world_.grid.dx, world_.grid.dz, 1e-6 * cell_steps_, at_first_, inflow_,
            outflow_, measure(world_).volume);
        return text;
    }
    std::snprintf(text, sizeof text, "grid of %zu x %zu cells of %.4g m x %.4g m, %.4g M cell-steps", world_.grid.nx,
                  world_.grid.nz, world_.grid.dx, world_.grid.dz, 1e-6 * cell_steps_);
    return text;
}

Measures measure(const ShallowWater& world) {
    const Grid& grid = world.grid;
    const double mass_of_depth = world.scene.fluid->rest_density * grid.cell_area();
    Measures sum;
    double squares = 0, momentum = 0;
    for (std::size_t k = 0; k < grid.nz; ++k) {
        const std::size_t c = grid.row(static_cast<std::ptrdiff_t>(k));
        for (std::size_t i = c; i < c + grid.nx; ++i) {
            const double h = world.water.h[i], u = world.primitive.u[i], v = world.primitive.v[i];
            const double open = world.openings.share_of(i);
            sum.volume += open * h;
            squares += open * h * h;
            momentum -= open * world.water.qx[i];
            sum.kinetic_energy += 0.5 * open * h * (u * u + v * v);
            sum.potential_energy += open * h * (world.bed.height[i] + 0.5 * h);
        }
    }
    sum.mean_depth = squares / sum.volume;
    sum.mean_speed = momentum / sum.volume;
    sum.kinetic_energy *= mass_of_depth;
    sum.potential_energy *= mass_of_depth * world.scene.world->gravity;
    sum.volume *= grid.cell_area();
    return sum;
}

void note_water(const ShallowWater& world, double driving_acceleration, double outflow, shm::Diagnostics& d) {
    const Measures all = measure(world);
    if (all.volume > 0) {
        d.mean_depth_m = all.mean_depth;
        d.mean_speed_m_s = all.mean_speed;
    }
    d.kinetic_energy_j = all.kinetic_energy;
    d.potential_energy_j = all.potential_energy;
    if (world.scene.channel->flow == Flow::recirculating) d.driving_acceleration_m_s2 = driving_acceleration;
    d.recycled_particles = static_cast<std::uint64_t>(std::max(0.0, outflow / particle_volume(world.scene.fluid)));
}

}  // namespace wade::fluid::shallow_water
