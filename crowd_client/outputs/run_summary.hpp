#pragma once
// How a run went: its status, its frames, its hashes, the health of its water.

#include <cstdint>
#include <exception>
#include <string>

#include "crowd_client/crowd_world.hpp"
#include "crowd_client/outputs/fluid_summary.hpp"
#include "shm_protocol/stream.hpp"

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

// Whether the step just taken is the last: the duration is over, or all agents have arrived or died and the scene says
// that the run ends then. A scene without agents runs for its whole duration.
[[nodiscard]] bool run_is_over(const CrowdWorld& crowd);

// "interrupted", "peer_dead", ...: the status that goes with an exit code.
[[nodiscard]] std::string status_of(int exit_code);

// The status of a run that an error ends: that of its exit code, or "disk_full".
[[nodiscard]] std::string status_of(const std::exception& error);

// Ends the summary of a run without errors, after its last frame: "completed", or "stream_ended" with a message.
void end_summary(RunSummary& summary, const CrowdWorld& crowd);

// Ends the summary of a run that an error ends. A run that had ended well and whose files cannot be written has failed,
// too; one that had failed before keeps its first reason.
void fail_summary(RunSummary& summary, const std::exception& error);

}  // namespace wade::crowd
