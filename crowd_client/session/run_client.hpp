#pragma once
// The loop of the crowd: a frame of water, the steps that are due with it, one entry in the log for each.

#include <cstdint>
#include <functional>

#include "crowd_client/crowd_world.hpp"
#include "crowd_client/outputs/run_summary.hpp"
#include "crowd_client/session/agents_stream.hpp"
#include "crowd_client/session/frame_source.hpp"

namespace wade::crowd {

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

// Runs until the scene's duration is over, until no agent is active if the scene says so, or until the stream ends.
// On return summary.status is "completed", or "stream_ended" if the producer ended before the scene's duration.
// agents: the way back, null if there is none. Errors pass through: shm::Error, RunError; both streams are told why.
void run_client(CrowdWorld& crowd, FrameSource& source, RunSummary& summary, const ClientHooks& hooks = {},
                AgentsPublisher* agents = nullptr);

// What the loops of one crowd (run_client) and of many (run_crowds) share.

// Throws RunError for a signal other than 0.
void stop_at_signal(int signal, std::uint64_t last_frame);

// Throws RunError if the frame is not one that may follow the last.
void check_order(const FrameSource& source, const shm::Frame& frame, std::uint64_t last_frame);

// Takes a frame into the summary once the crowd has walked through it.
void note_frame(RunSummary& summary, const FrameSource& source, const shm::Frame& frame);

}  // namespace wade::crowd
