#pragma once
// The loop of the crowd: a frame of water, the steps that are due with it, one entry in the log for each. With many
// crowds a frame is taken, checked and sorted once, then each crowd steps through it.
//
//   frame ---> bins ---+---> crowd 0: its steps, its log
//   (checked) (sorted) +---> crowd 1: its steps, its log      bins are only read; a crowd touches nothing but itself,
//                      +---> ...                              so that threads may divide the crowds freely

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <span>
#include <string>

#include "crowd_client/crowd_world.hpp"
#include "crowd_client/results/run_summary.hpp"
#include "crowd_client/session/agents_stream.hpp"
#include "crowd_client/session/frame_source.hpp"

namespace wade::crowd {

struct CrowdRun {
    CrowdWorld crowd;
    RunSummary summary = {};          // kept complete up to the last frame when the loop throws
    bool over = false;                // further frames are ignored
    std::exception_ptr failure = {};  // the error that stopped this crowd or kept its files from being written
};

struct RunHooks {
    // Before each frame is asked for, to pause and to take commands.
    std::function<void()> before_frame = {};
    // After each step of crowd k, before the frame is released, to log. Several threads call it, but never two at once
    // for one crowd.
    std::function<void(std::size_t k, const WaterView&)> on_step = {};
    // After the steps of all crowds, before the frame is released.
    std::function<void(const shm::Frame&)> on_frame = {};
    // Once crowd k is over, its summary complete, after the frame is released, to write its last files.
    std::function<void(std::size_t k)> on_over = {};
    // The signal that asks to stop, 0 = none. Asked before each step, by several threads.
    std::function<int()> interrupted = {};
    // Whether the user asks to end the run after the last frame; the producer then gets a goodbye.
    std::function<bool()> quit = {};
    // A sentence about implausible water, once for each kind.
    std::function<void(const std::string&)> warn = {};
};

// Runs until each crowd is over or the stream ends. A crowd is over when the scene's duration is, or when no agent is active
// if the scene says so; its status is then "completed", or "stream_ended" if the producer ended before that. Each of many
// crowds ends up, to the bit, as if it had been alone. All must have the world of the first; threads >= 1.
//   agents     the agents stream of the only crowd, null if there is none
// An error in a hook of one crowd ends this crowd, see `failure`; its summary says why, and the others go on. If errors
// stop all crowds, that of the first one passes through, with both streams told why. So do errors of a stream and
// signals (shm::Error, RunError); crowds that were not over stay so.
void run_crowds(std::span<CrowdRun> crowds, FrameSource& source, const RunHooks& hooks = {}, int threads = 1,
                AgentsPublisher* agents = nullptr);

}  // namespace wade::crowd
