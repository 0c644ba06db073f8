#pragma once
// The crowds of a run, each with its folder: one crowd, or the crowds of a list (--crowds).

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

// Data of a crowd beside its CrowdRun of the same index.
struct Member {
    std::string name;  // empty if it is the only one
    std::filesystem::path place;
    RunLabels labels;
    Record kept;
    std::unique_ptr<RunFolder> folder;  // none before open_folders() and after finish()
    bool finished = false;
    std::size_t warnings_told = 0;  // number of the crowd's warnings that were printed
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

// Returns the crowds of the command line, before their first step; touches no file. Throws ConfigurationError for a
// scene, a list or options that cannot be run, and for too little memory before any is taken.
[[nodiscard]] Party make_party(const ProgramStart& start);

// Creates the folders and their first files. Throws as RunFolder.
void open_folders(Party& party, Console& console);

// Writes the last files of crowd k, once, or what can be written if the first ones failed. An error becomes the crowd's
// failure, if it had none before.
void finish(Party& party, std::size_t k, Console& console);

// Gives the crowds that are not over the reason for a bad end of the run.
void give_up(Party& party, const std::exception& error);

// Writes the files of a list of crowds beside the folders. Throws OutputError.
void sum_up(const Party& party);

}  // namespace wade::crowd
