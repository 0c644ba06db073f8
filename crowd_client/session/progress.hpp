#pragma once
// The texts that tell a user how a run goes.

#include <string>

#include "crowd_client/session/run_client.hpp"

namespace wade::crowd {

// One line: simulated time, step, agents, health of the water, real-time factor and time to go.
//   "t 12.0 s  step 360/12000  active 48 arrived 2 dead 0  water 26880 particles, density error 0.012 %, ..."
// wall_time: s since the first frame was asked for.
[[nodiscard]] std::string progress_line(const CrowdWorld& crowd, const shm::Frame& frame, double wall_time);

// The same of many crowds: how many still walk, with how many agents.
struct CrowdsProgress {
    std::size_t crowds = 0, walking = 0, active = 0;
    double time = 0;  // s
};
[[nodiscard]] std::string progress_line(const CrowdsProgress& crowds, const shm::Frame& frame, double wall_time);

// Two lines at the end of a run, the second without a line end.
[[nodiscard]] std::string summary_text(const CrowdWorld& crowd, const RunSummary& summary, double wall_time);

}  // namespace wade::crowd
