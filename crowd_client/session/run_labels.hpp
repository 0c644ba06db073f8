#pragma once
// What a run is called and where it came from, for its records.

#include <string>
#include <vector>

#include "configs/program/command_line.hpp"
#include "crowd_client/results/output_writer.hpp"
#include "crowd_client/results/run_labels.hpp"

namespace wade::crowd {

// The labels of a run that starts now, its fluid model not yet known.
[[nodiscard]] RunLabels labels_of(const ProgramStart& start);

// What the options say about the files that grow step by step.
[[nodiscard]] Record record_of(const RunOptions& options);

// The command without what differs between two runs of the same thing: the folder of the program, the options --out,
// --session and --commands.
[[nodiscard]] std::vector<std::string> portable_command(const std::vector<std::string>& arguments);

}  // namespace wade::crowd
