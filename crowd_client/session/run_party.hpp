#pragma once
// A run of crowd_client: joins the water, walks its crowds through it, writes their files.

#include "configs/program/command_line.hpp"
#include "configs/program/program.hpp"

namespace wade::crowd {

// Runs the crowd of the scene or, with --crowds, all of a list. The files of a crowd are complete as soon as it is over;
// a path to the results goes to stdout at the end, be it good or bad. Returns the exit code.
// Water that waits for a crowd that fails before it has joined is told why.
[[nodiscard]] int run_party(const ProgramStart& start, Console& console);

// What --check of crowd_client says beside what the scene's check says; throws for all that a run would refuse.
[[nodiscard]] std::string check_party(const ProgramStart& start);

}  // namespace wade::crowd
