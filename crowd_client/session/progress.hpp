#pragma once
// The texts that tell a user how a run goes.

#include <optional>
#include <string>

#include "crowd_client/crowd_world.hpp"
#include "crowd_client/results/run_summary.hpp"
#include "shm_protocol/stream.hpp"

namespace wade::crowd {

// Returns one line of at most 100 columns: simulated time, agents, water, its health, pace and time to go. A longer
// line loses the health, then the water.
//   "t 12.0/400 s  active 48 arrived 2 dead 0  26880 particles, error 0.012 %  1.25 x real, 6 min to go"
// pace: simulated time over wall time, 0 = not known. left: wall time until the end of the scene (TimeLeft), s.
[[nodiscard]] std::string progress_line(const CrowdWorld& crowd, const shm::Frame& frame, double pace,
                                        std::optional<double> left);

// The same for many crowds: how many are not over, with how many agents.
struct CrowdsProgress {
    std::size_t crowds = 0, walking = 0, active = 0;
    double time = 0;  // s
};
[[nodiscard]] std::string progress_line(const CrowdsProgress& crowds, const shm::Frame& frame, double pace);

// Lines at the end of a run, the last one without a line end.
[[nodiscard]] std::string summary_text(const CrowdWorld& crowd, const RunSummary& summary, double wall_time);

// Returns the duration of each stage of a step, one line each; empty if it was not measured.
[[nodiscard]] std::string step_times_text(const CrowdWorld& crowd);

}  // namespace wade::crowd
