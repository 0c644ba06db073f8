#pragma once
// A run of crowd_client: joins the water, steps its crowds through it, writes their files.

#include "configs/program/command_line.hpp"
#include "configs/program/program.hpp"

namespace wade::crowd {

// Runs the crowd of the scene or, with --crowds, all of a list. The files of a crowd are complete as soon as it is
// over; a path to the results goes to stdout at the end, good or bad. Returns the exit code. If a crowd fails before it
// has joined, it tells the waiting water why.
[[nodiscard]] int run_party(const ProgramStart& start, Console& console);

// Returns the text of crowd_client's --check beside the scene's check; throws for all that a run would refuse.
[[nodiscard]] std::string check_party(const ProgramStart& start);

}  // namespace wade::crowd
