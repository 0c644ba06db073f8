#pragma once
// The loop of the crowd: a frame of water, the steps that are due with it, one entry in the log for each.

#include <cstdint>
#include <exception>
#include <functional>
#include <string>

#include "configs/scene_frames.hpp"
#include "crowd_client/agents_stream.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/fluid_summary.hpp"
#include "crowd_client/frame_source.hpp"

namespace wade::crowd {

// How a run went so far. Kept by the caller, so that it is complete up to the last frame when the loop throws.
struct RunSummary {
    std::string status = "running";
    std::string message;               // why the run ended badly, a full sentence
    std::uint64_t frames = 0;          // of the water, taken
    std::uint64_t last_frame = 0;      // number of the last of them
    double time = 0;                   // s, of the last of them
    std::uint64_t dropped_frames = 0;  // not seen, outside lockstep only
    std::uint64_t frame_hash = 0;      // chain over them; 0 = unknown, as it is outside lockstep
    std::uint64_t agents_hash = 0;     // chain over the frames of agents, 0 = none were made
    FluidSummary fluid;
};

struct ClientHooks {
    // Before each frame is asked for; the place to pause and to take commands.
    std::function<void()> before_frame = {};
    // After each step, before the frame is released; the place to log.
    std::function<void(const CrowdWorld&, const WaterView&)> on_step = {};
    // After the steps of a frame, before it is released.
    std::function<void(const CrowdWorld&, const shm::Frame&)> on_frame = {};
    // The signal that asks to stop, 0 = none.
    std::function<int()> interrupted = {};
    // Whether the user asks to end the run after the last frame; the producer then gets a goodbye.
    std::function<bool()> quit = {};
};

// Whether the step just taken is the last: the duration is over, or all agents have arrived or died and the scene says
// that the run ends then. A scene without agents runs for its whole duration.
[[nodiscard]] bool run_is_over(const CrowdWorld& crowd);

// Runs until the scene's duration is over, until no agent is active if the scene says so, or until the stream ends.
// On return summary.status is "completed", or "stream_ended" if the producer ended before the scene's duration.
// agents: the way back, null if there is none. Errors pass through: shm::Error, RunError; both streams are told why.
void run_client(CrowdWorld& crowd, FrameSource& source, RunSummary& summary, const ClientHooks& hooks = {},
                AgentsPublisher* agents = nullptr);

// "interrupted", "peer_dead", ...: the status that goes with an exit code.
[[nodiscard]] std::string status_of(int exit_code);

// The status of a run that an error ends: that of its exit code, or "disk_full".
[[nodiscard]] std::string status_of(const std::exception& error);

// What the loops of one crowd (run_client) and of many (run_crowds) share.

// Throws RunError for a signal other than 0.
void stop_at_signal(int signal, std::uint64_t last_frame);

// Throws RunError if the frame is not one that may follow the last.
void check_order(const FrameSource& source, const shm::Frame& frame, std::uint64_t last_frame);

// Takes a frame into the summary once the crowd has walked through it.
void note_frame(RunSummary& summary, const FrameSource& source, const shm::Frame& frame);

// Ends the summary of a run without errors, after its last frame: "completed", or "stream_ended" with a message.
void end_summary(RunSummary& summary, const CrowdWorld& crowd);

// Ends the summary of a run that an error ends. A run that had ended well and whose files cannot be written has failed,
// too; one that had failed before keeps its first reason.
void fail_summary(RunSummary& summary, const std::exception& error);

}  // namespace wade::crowd
