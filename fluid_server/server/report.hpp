#pragma once
// What the server tells its user: a line now and then, a summary at the end.

#include <string>

#include "fluid_server/server/run_server.hpp"

namespace wade::fluid {

// One line on the frame just sent; wall: time since the start of the run, s, above 0.
[[nodiscard]] std::string progress_line(const ServerRun& run, const ServerSummary& summary, double wall);

// How the run went.
[[nodiscard]] std::string summary_text(const ServerRun& run, const ServerSummary& summary, double wall);

}  // namespace wade::fluid
