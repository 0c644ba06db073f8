#include "fluid_server/server/run_server.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <fstream>
#include <optional>
#include <string>

#include "configs/program/peer_support.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/fluid.hpp"

namespace wade::fluid {

namespace {

std::uint64_t resident_bytes() {
    std::ifstream statm("/proc/self/statm");
    std::uint64_t total = 0;
    std::uint64_t resident = 0;
    statm >> total >> resident;
    return statm ? resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) : 0;
}

void add_frame(ServerSummary& summary, const shm::Diagnostics& d, double duration) {
    ++summary.frames;
    summary.steps += d.sub_steps;
    summary.solver_time += 1e-9 * static_cast<double>(d.solver_ns);
    if (!std::isnan(d.driving_acceleration_m_s2)) summary.driving_impulse += d.driving_acceleration_m_s2 * duration;
    summary.resident_bytes = std::max(summary.resident_bytes, d.resident_bytes);
    summary.last = d;
}

// A wait for the agents; if the crowd goes meanwhile, the stream of water says how. False if it left in peace.
template <typename Work>
bool beside_crowd(const ServerRun& run, Work&& work) {
    try {
        const bool there = work();
        run.publisher.set_paused(false);  // as it may be while the crowd pauses
        return there;
    } catch (const shm::Error& error) {
        if (error.failure() != shm::Failure::interrupted || run.interrupted() != 0) throw;
        if (!run.publisher.check_consumers()) return false;
        throw;
    }
}

// One frame; false if the crowd is no longer there.
bool send_frame(const ServerRun& run, std::uint64_t frame, ServerSummary& summary) {
    const auto check_interrupted = [&] {
        if (run.interrupted() == 0) return;
        throw shm::Error(shm::Failure::interrupted, "interrupted by a signal at frame " + std::to_string(frame));
    };
    const auto idle = [&] {
        run.publisher.heartbeat();
        check_interrupted();
    };
    run.hold();
    check_interrupted();
    const FrameInterval interval = run.clock.next_frame(idle);
    if (run.agents != nullptr && !beside_crowd(run, [&] { return run.agents->take(frame, run.model); })) return false;
    shm::Diagnostics diagnostics = run.model.advance_frame(interval);
    diagnostics.resident_bytes = resident_bytes();
    add_frame(summary, diagnostics, interval.duration());
    check_interrupted();
    run.clock.wait_until_due(idle);
    const std::optional<shm::FrameFields> slot = run.publisher.begin_frame();
    if (!slot) return false;
    summary.particles = run.model.write_frame(*slot);
    summary.particle_steps += std::uint64_t{summary.particles} * diagnostics.sub_steps;
    run.publisher.end_frame(summary.particles, diagnostics, run.clock.ended(), interval.end_tick);
    run.clock.note_sent();
    run.on_frame(diagnostics);
    return true;
}

}  // namespace

shm::StreamInfo stream_info(const Scene& scene, const FluidModel& model) {
    const Ticks ticks = ticks_of(scene.frame_rate);
    shm::StreamInfo info;
    info.producer_name = model.name();
    info.capacity = model.capacity();
    info.depth = static_cast<std::uint32_t>(scene.lockstep_depth);
    info.ticks_per_frame = ticks.per_frame;
    info.ticks_per_second = ticks.per_second;
    info.particle_radius = 0.5 * scene.fluid->particle_spacing;
    info.rest_density = scene.fluid->rest_density;
    info.column_width = model.column_width();
    info.scene_hash = scene.hash;
    info.coupling_lag = scene.coupling->agents_stream == AgentsStream::parallel ? 1 : 0;
    return info;
}

void run_server(const ServerRun& run, ServerSummary& summary) {
    try {
        if (run.consumers > 0) run.publisher.wait_for_consumers(run.consumers);
        const auto join = [&] {
            run.agents->join(run.model.name());
            return true;
        };
        summary.crowd_left = run.agents != nullptr && !beside_crowd(run, join);
        run.clock.start();
        while (!run.clock.ended() && !summary.crowd_left) {
            summary.crowd_left = !send_frame(run, summary.frames + 1, summary);
        }
        if (run.agents != nullptr) run.agents->leave();
        run.publisher.close();
    } catch (const std::exception& error) {
        const int code = exit_code_of<shm::Error>(error);
        if (run.agents != nullptr) run.agents->abort(code, error.what());
        run.publisher.abort(code, error.what());
        throw;
    }
}

}  // namespace wade::fluid
