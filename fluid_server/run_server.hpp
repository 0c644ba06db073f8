#pragma once
// The loop of the server: advance the fluid by one frame, publish it, until the scene or the crowd is done.

#include <cstdint>
#include <functional>

#include "fluid_server/fluid_world.hpp"
#include "shm_protocol/publisher.hpp"

namespace wade::fluid {

// How a run went, kept by the caller so that it is complete up to the last frame when the loop throws.
struct ServerSummary {
    std::uint64_t frames = 0;  // simulated; the last of a run that ended early may not have been sent
    std::uint64_t steps = 0;
    std::uint64_t particle_steps = 0;
    double solver_time = 0;            // s, wall
    double driving_impulse = 0;        // m/s: driving acceleration summed over time
    std::uint64_t resident_bytes = 0;  // memory of this process, the most seen; 0 = not known
    bool crowd_left = false;           // every consumer said goodbye before frame `frames` was sent
};

// What travels in the header of the stream.
[[nodiscard]] shm::StreamInfo stream_info(const Scene& scene);

// Advances the world by the duration of one frame and collects its diagnostics. Throws RunError (numerical_failure).
shm::Diagnostics advance_frame(FluidWorld& world, ServerSummary& summary);

// Writes the particles into the slot of a frame; returns their number.
std::uint32_t write_frame(const FluidWorld& world, const shm::FrameFields& slot);

// Runs to the end; on_frame is called after each published frame, interrupted() between them. Every error passes
// through, RunError and shm::Error with a meaning of their own; the consumers are told the reason.
void run_server(FluidWorld& world, shm::Publisher& publisher, ServerSummary& summary,
                const std::function<void(const shm::Diagnostics&)>& on_frame, const std::function<int()>& interrupted);

}  // namespace wade::fluid
