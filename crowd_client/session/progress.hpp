#pragma once
// The texts that tell a user how a run goes.

#include <string>
#include <vector>

#include "crowd_client/crowd_world.hpp"
#include "crowd_client/outputs/run_summary.hpp"
#include "shm_protocol/stream.hpp"

namespace wade::crowd {

// How fast the run is now: simulated time over wall time, of the last fifth of the run so far, as particles that come or go
// make it slower or faster.
class Pace {
 public:
    // Both in s and growing, since the run began. Returns the pace, 0 while it is not known.
    double at(double simulated, double wall);

 private:
    struct Mark {
        double simulated, wall;
    };
    std::vector<Mark> marks_{{0, 0}};
};

// One line of at most 100 columns: simulated time, agents, water, its health, pace and time to go; where it would be longer
// the health is left out, then the water.
//   "t 12.0/400 s  active 48 arrived 2 dead 0  26880 particles, error 0.012 %  1.25 x real, 6 min to go"
// pace: simulated time over wall time, 0 = not known.
[[nodiscard]] std::string progress_line(const CrowdWorld& crowd, const shm::Frame& frame, double pace);

// The same of many crowds: how many still walk, with how many agents.
struct CrowdsProgress {
    std::size_t crowds = 0, walking = 0, active = 0;
    double time = 0;  // s
};
[[nodiscard]] std::string progress_line(const CrowdsProgress& crowds, const shm::Frame& frame, double pace);

// Lines at the end of a run, the last one without a line end.
[[nodiscard]] std::string summary_text(const CrowdWorld& crowd, const RunSummary& summary, double wall_time);

// How long each stage of a step took, one line each; empty if nobody counted.
[[nodiscard]] std::string step_times_text(const CrowdWorld& crowd);

}  // namespace wade::crowd
