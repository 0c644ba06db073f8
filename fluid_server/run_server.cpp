#include "fluid_server/run_server.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <fstream>

#include "configs/peer_support.hpp"
#include "configs/scene_frames.hpp"
#include "fluid_server/parallel.hpp"
#include "fluid_server/river_measures.hpp"

namespace wade::fluid {

namespace {

// A power of ten that gives at least a million ticks a second, so that a rate such as 29.97 frames/s is a whole number
// of ticks and rounding changes no rate by more than 5e-7 of itself.
std::uint64_t ticks_per_frame(double frame_rate) {
    std::uint64_t ticks = 1;
    while (frame_rate * static_cast<double>(ticks) < 1e6 && ticks < 1'000'000'000'000) {
        ticks *= 10;
    }
    return ticks;
}

std::uint64_t resident_bytes() {
    std::ifstream statm("/proc/self/statm");
    std::uint64_t total = 0;
    std::uint64_t resident = 0;
    statm >> total >> resident;
    return statm ? resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) : 0;
}

}  // namespace

shm::StreamInfo stream_info(const Scene& scene) {
    shm::StreamInfo info;
    info.producer_name = "dfsph";
    info.capacity = static_cast<std::uint32_t>(std::max(scene.fluid.max_particles, 1));
    info.depth = static_cast<std::uint32_t>(scene.lockstep_depth);
    info.slots = info.depth;
    info.ticks_per_frame = ticks_per_frame(scene.frame_rate);
    const double ticks_per_second = scene.frame_rate * static_cast<double>(info.ticks_per_frame);
    info.ticks_per_second = static_cast<std::uint64_t>(std::max(1LL, std::llround(ticks_per_second)));
    info.particle_radius = 0.5 * scene.fluid.particle_spacing;
    info.rest_density = scene.fluid.rest_density;
    info.scene_hash = scene.hash;
    return info;
}

shm::Diagnostics advance_frame(FluidWorld& world, ServerSummary& summary) {
    const auto start = std::chrono::steady_clock::now();
    const double frame_time = 1 / world.scene().frame_rate;
    shm::Diagnostics d;
    d.mean_density_error = 0;
    d.max_density_error = 0;
    double driving = 0;
    double remaining = frame_time;
    // What is left after the last sub-step is rounding.
    while (remaining > 1e-9 * frame_time) {
        const StepReport step = world.step(remaining);
        remaining -= step.dt;
        ++d.sub_steps;
        d.last_dt_s = step.dt;
        d.density_iterations += static_cast<std::uint32_t>(step.density.iterations);
        d.divergence_iterations += static_cast<std::uint32_t>(step.divergence.iterations);
        d.mean_density_error += step.mean_density_error;
        d.max_density_error = std::max(d.max_density_error, step.max_density_error);
        driving += step.driving_acceleration * step.dt;
        summary.particle_steps += world.particles().count;
    }
    const auto elapsed = std::chrono::steady_clock::now() - start;
    const RiverMeasures river =
        measure_river(world.particles(), static_cast<double>(world.particle_mass()), world.scene().world.gravity);
    d.mean_density_error /= d.sub_steps;
    d.solver_ns = static_cast<std::uint64_t>(std::chrono::nanoseconds(elapsed).count());
    d.mean_depth_m = river.mean_depth;
    d.mean_speed_m_s = river.mean_speed;
    d.kinetic_energy_j = river.kinetic_energy;
    d.potential_energy_j = river.potential_energy;
    if (world.scene().channel.flow == Flow::recirculating) {
        d.driving_acceleration_m_s2 = driving / frame_time;
    }
    d.position_clamps = world.position_clamps();
    d.recycled_particles = world.recycled();
    d.resident_bytes = resident_bytes();

    ++summary.frames;
    summary.steps += d.sub_steps;
    summary.solver_time += std::chrono::duration<double>(elapsed).count();
    summary.driving_impulse += driving;
    summary.resident_bytes = std::max(summary.resident_bytes, d.resident_bytes);
    return d;
}

std::uint32_t write_frame(const FluidWorld& world, const shm::FrameFields& slot) {
    const Particles& p = world.particles();
    const float mass = world.particle_mass();
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t) {
        std::fill(slot.mass.begin() + static_cast<std::ptrdiff_t>(begin),
                  slot.mass.begin() + static_cast<std::ptrdiff_t>(end), mass);
        const auto copy = [&](const std::vector<float>& from, std::span<float> to) {
            std::copy(from.begin() + static_cast<std::ptrdiff_t>(begin),
                      from.begin() + static_cast<std::ptrdiff_t>(end), to.begin() + static_cast<std::ptrdiff_t>(begin));
        };
        copy(p.vx, slot.vx);
        copy(p.vy, slot.vy);
        copy(p.vz, slot.vz);
        copy(p.x, slot.px);
        copy(p.y, slot.py);
        copy(p.z, slot.pz);
    });
    return static_cast<std::uint32_t>(p.count);
}

void run_server(FluidWorld& world, shm::Publisher& publisher, ServerSummary& summary,
                const std::function<void(const shm::Diagnostics&)>& on_frame, const std::function<int()>& interrupted) {
    const std::uint64_t frames = frames_of(world.scene());
    try {
        publisher.wait_for_consumers(1);
        for (std::uint64_t frame = 1; frame <= frames; ++frame) {
            const shm::Diagnostics diagnostics = advance_frame(world, summary);
            if (interrupted() != 0) {
                throw shm::Error(shm::Failure::interrupted,
                                 "interrupted by a signal at frame " + std::to_string(frame));
            }
            const auto slot = publisher.begin_frame();
            if (!slot) {
                summary.crowd_left = true;
                break;
            }
            const std::uint32_t count = write_frame(world, *slot);
            publisher.end_frame(count, diagnostics, frame == frames);
            on_frame(diagnostics);
        }
        publisher.close();
    } catch (const std::exception& error) {
        publisher.abort(exit_code_of<shm::Error>(error), error.what());
        throw;
    }
}

}  // namespace wade::fluid
