#pragma once
// The texts that tell a user how a run goes.

#include <string>

#include "crowd_client/run_client.hpp"

namespace wade::crowd {

// One line: simulated time, frame, agents, health of the water, real-time factor and time to go.
//   "t 12.0 s  frame 360/12000  active 48 arrived 2 dead 0  water 26880 particles, density error 0.012 %, ..."
// wall_time: s since the first frame was asked for.
[[nodiscard]] std::string progress_line(const CrowdWorld& crowd, const shm::Frame& frame, double wall_time);

// Two lines at the end of a run, the second without a line end.
[[nodiscard]] std::string summary_text(const CrowdWorld& crowd, const RunSummary& summary, double wall_time);

// Decides when a line is due: on a terminal several times a second, else every 10 s of simulated time.
class ProgressPacer {
 public:
    explicit ProgressPacer(bool terminal) : terminal_(terminal) {}
    // sim_time and wall_time in s, both growing.
    [[nodiscard]] bool due(double sim_time, double wall_time);

 private:
    bool terminal_;
    double next_ = 0;  // s of wall time on a terminal, else of simulated time
};

}  // namespace wade::crowd
