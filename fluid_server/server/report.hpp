#pragma once
// What the server tells its user: a line now and then, a summary at the end.

#include <string>

#include "configs/program/time_left.hpp"
#include "fluid_server/server/run_server.hpp"

namespace wade::fluid {

// One line of at most 100 columns on the frame just sent.
[[nodiscard]] std::string progress_line(const ServerRun& run, const ServerSummary& summary, const TimeLeft& left);

// How the run went.
[[nodiscard]] std::string summary_text(const ServerRun& run, const ServerSummary& summary, double wall);

}  // namespace wade::fluid
