#pragma once
// crowd_client --crowds FILE: many crowds through the water of one fluid server.

#include <string>

#include "configs/program/command_line.hpp"
#include "configs/program/program.hpp"

namespace wade::crowd {

// Runs all crowds of the list; each has the run folder OUT/<name>/ with the files of a run of its own, complete as soon
// as this crowd is over. OUT/crowds.csv sums them up at the end, be it good or bad. Returns the exit code.
// Throws ConfigurationError for a list that cannot be run, before anything starts.
[[nodiscard]] int run_list_of_crowds(const ProgramStart& start, Console& console);

// What --check says about the list of crowds, one line; throws as load_crowds.
[[nodiscard]] std::string check_of_crowds(const ProgramStart& start);

}  // namespace wade::crowd
