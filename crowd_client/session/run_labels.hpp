#pragma once
// Labels of a run for its records: its name and origin.

#include <string>
#include <vector>

#include "configs/program/command_line.hpp"
#include "crowd_client/results/output_writer.hpp"
#include "crowd_client/results/run_labels.hpp"

namespace wade::crowd {

// The labels of a run that starts now, its fluid model not yet known.
[[nodiscard]] RunLabels labels_of(const ProgramStart& start);

// Returns which files that grow step by step the options ask for.
[[nodiscard]] Record record_of(const RunOptions& options);

// Returns the command without the parts that differ between two equal runs: the folder of the program, the options
// --out, --session and --commands.
[[nodiscard]] std::vector<std::string> portable_command(const std::vector<std::string>& arguments);

}  // namespace wade::crowd
