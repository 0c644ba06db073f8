#pragma once
// The loop of many crowds in one water: each frame is taken, checked and sorted once, then each crowd walks through it.
//
//   frame ---> bins ---+---> crowd 0: its steps, its log
//   (checked) (sorted) +---> crowd 1: its steps, its log      bins are only read; a crowd touches nothing but itself,
//                      +---> ...                              so that threads may share the crowds in any way

#include <cstddef>
#include <exception>
#include <functional>
#include <span>

#include "crowd_client/session/run_client.hpp"

namespace wade::crowd {

struct CrowdRun {
    CrowdWorld crowd;
    RunSummary summary;               // as of a run of this crowd alone
    bool over = false;                // from then on the frames pass it by
    std::exception_ptr failure = {};  // the error that stopped this crowd alone or kept its files from being written
};

struct CrowdsHooks {
    // Before each frame is asked for; the place to pause.
    std::function<void()> before_frame = {};
    // After each step of crowd k, before the frame is released. Called by several threads, but for one crowd by one.
    std::function<void(std::size_t k, const WaterView&)> on_step = {};
    // Once crowd k is over, its summary complete, after the frame is released; the place to write its last files.
    std::function<void(std::size_t k)> on_over = {};
    // After the steps of all crowds, before the frame is released.
    std::function<void(const shm::Frame&)> on_frame = {};
    // The signal that asks to stop, 0 = none. Asked before each step, by several threads.
    std::function<int()> interrupted = {};
    // Whether the user asks to end the run after the last frame.
    std::function<bool()> quit = {};
};

// Runs until each crowd is over, as run_client says for one, or until the stream ends. Each crowd ends up, to the bit,
// as if it had been alone. All must have the world of the first; threads >= 1.
// An error in a hook of one crowd ends this crowd only, see `failure`; its summary says why, and the others walk on. If
// errors stop all crowds, that of the first crowd passes through.
// Errors of the stream and signals pass through: shm::Error, RunError; the producer is told why, and crowds that were not
// over stay so.
void run_crowds(std::span<CrowdRun> crowds, FrameSource& source, const CrowdsHooks& hooks, int threads);

}  // namespace wade::crowd
