#pragma once
// A run of the server: its session, its clock, the agents that come back, and what it leaves behind however it ends.

#include <string>
#include <vector>

#include "configs/program/command_line.hpp"
#include "configs/program/program.hpp"
#include "fluid_server/fluid_model.hpp"

namespace wade::fluid {

// Options of the server that no other program has.
[[nodiscard]] std::vector<ProgramOption> server_options();

// Goes on from --from-state and sees whether --save-state can be done. Returns what there is to say, one line each. Throws
// ConfigurationError.
[[nodiscard]] std::vector<std::string> prepare_states(FluidModel& model, const RunOptions& options);

// Tells a crowd that already waits for this session why no water will come; does nothing if none waits. For a server
// that fails before serve(). code: the exit code.
void tell_waiting_crowd(const ProgramStart& start, int code, const std::string& why) noexcept;

// Sends the water of the scene to the consumers of its session until the scene ends. Every error passes through, after
// the consumers know it and the server has saved what it can.
void serve(const ProgramStart& start, FluidModel& model, Console& console);

}  // namespace wade::fluid
