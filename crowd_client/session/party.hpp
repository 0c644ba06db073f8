#pragma once
// The crowds of a run, each with its folder: one, or those of a list (--crowds).

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "configs/program/command_line.hpp"
#include "configs/program/program.hpp"
#include "crowd_client/outputs/run_folder.hpp"
#include "crowd_client/results/stopwatch.hpp"
#include "crowd_client/session/run_crowds.hpp"

namespace wade::crowd {

// A crowd beside its CrowdRun of the same place.
struct Member {
    std::string name;  // empty if it is the only one
    std::filesystem::path place;
    RunLabels labels;
    Record kept;
    std::unique_ptr<RunFolder> folder;  // none before open_folders() and after finish()
    bool finished = false;
    std::size_t warnings_told = 0;  // of the crowd's
};

struct Party {
    std::filesystem::path out;
    bool many = false;  // of a list: each has the folder OUT/<name>/, and OUT/crowds.csv sums up
    std::vector<CrowdRun> runs;
    std::vector<Member> members;
    Stopwatch clock;
};

// "the crowd: 50 agents, 12 MB of memory"
[[nodiscard]] std::string size_of_party(const Party& party);

// The crowds that the command line asks for, before their first step; touches no file.
// Throws ConfigurationError for a scene, a list or options that cannot be run, memory that is not there before any is taken.
[[nodiscard]] Party make_party(const ProgramStart& start);

// Creates the folders and their first files. Throws as RunFolder.
void open_folders(Party& party, Console& console);

// Writes the last files of crowd k, once, or what can be written where the first ones failed; an error is the crowd's
// failure, if it had none before.
void finish(Party& party, std::size_t k, Console& console);

// Crowds that are not over when the run ends badly get its reason.
void give_up(Party& party, const std::exception& error);

// Writes what a list of crowds has beside the folders. Throws OutputError.
void sum_up(const Party& party);

}  // namespace wade::crowd
