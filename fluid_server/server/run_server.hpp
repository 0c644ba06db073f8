#pragma once
// The loop of the server: compute the next frame of the water, publish it, until the scene or the crowd is done.

#include <cstdint>
#include <functional>

#include "fluid_server/fluid_model.hpp"
#include "fluid_server/server/agents_inlet.hpp"
#include "fluid_server/server/run_clock.hpp"
#include "shm_protocol/publisher.hpp"

namespace wade::fluid {

// How a run went, kept by the caller so that it is complete up to the last frame when the loop throws.
struct ServerSummary {
    std::uint64_t frames = 0;     // simulated; the last of a run that ended early may not have been sent
    std::uint32_t particles = 0;  // of the last frame sent
    std::uint64_t steps = 0;
    std::uint64_t particle_steps = 0;
    double solver_time = 0;            // s, wall; 0 = not known
    double driving_impulse = 0;        // m/s: driving acceleration summed over time
    std::uint64_t resident_bytes = 0;  // memory of this process, the most seen; 0 = not known
    shm::Diagnostics last;             // of the last frame simulated
    bool crowd_left = false;           // every consumer said goodbye before frame `frames` was sent
};

// What travels in the header of the stream.
[[nodiscard]] shm::StreamInfo stream_info(const Scene& scene, const FluidModel& model);

// Model, publisher, clock, agents and consumers of a run.
struct ServerRun {
    FluidModel& model;
    shm::Publisher& publisher;
    RunClock& clock;
    AgentsInlet* agents = nullptr;  // null: the scene has no agents stream
    int consumers = 1;              // to wait for before frame 1
    std::function<int()> interrupted = [] { return 0; };
    std::function<void()> hold = [] {};                                    // before each frame; pauses are spent here
    std::function<void(const shm::Diagnostics&)> on_frame = [](auto&) {};  // after each published frame
};

// Runs to the end. Every error passes through, RunError and shm::Error with a meaning of their own; the consumers are
// told the reason.
void run_server(const ServerRun& run, ServerSummary& summary);

}  // namespace wade::fluid
