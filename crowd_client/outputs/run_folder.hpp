#pragma once
// The files of one run, kept complete up to the last step at any moment.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "crowd_client/outputs/output_list.hpp"
#include "crowd_client/results/output_file.hpp"
#include "crowd_client/results/stopwatch.hpp"

namespace wade::crowd {

// Returns the number of files that the folder of such a run keeps open until it is finished.
[[nodiscard]] std::size_t files_kept_open(const Scene& scene, const Record& kept);

// Raises this process's limit of open files, so that crowds can keep as many open each as `per_crowd` says: up to five
// each, where the usual limit of 1024 would end at some 200 crowds.
// Throws ConfigurationError if even the largest limit that the process may have is too low.
void allow_open_files(std::span<const std::size_t> per_crowd);

// Returns what a folder holds of an earlier run, from its outcome.json: "s05, 50 of 50 arrived"; empty if there is
// none.
[[nodiscard]] std::string earlier_run(const std::filesystem::path& folder);

// All outputs of a run, called together (output_list.hpp). Until the run is finished the folder also has `.reserve`:
// space for the last files, so that a full disk keeps none of them out.
class RunFolder {
 public:
    using Warn = std::function<void(const std::string&)>;

    // Creates the folder and its first files; results of an earlier run in it are replaced. warn: gets sentences for the
    // user.
    // Throws ConfigurationError if the folder cannot be made or written to, OutputError for a file in it.
    RunFolder(std::filesystem::path folder, const CrowdWorld& crowd, const RunLabels& labels, const Record& kept,
              Warn warn = {}, std::span<const RegisteredOutput> list = outputs());

    // Logs the state after a step. Throws OutputError.
    void record(const CrowdWorld& crowd, const WaterView& water);

    // Writes the current results, so that a killed run loses few arrivals. Does so every two seconds of wall time, or
    // less often, so that it takes at most a hundredth of the wall time. Throws OutputError.
    void keep_results(const CrowdWorld& crowd, const RunSummary& summary, const RunLabels& labels);

    // Logs an event that was not in the scene, so that the scene as it was played repeats the run. Throws OutputError.
    void record_event(const TauEvent& event);

    // Writes the final files. Tries all of them, then throws the first error. The error also stands in the summary, and
    // in the final files that can be written.
    void finish(const CrowdWorld& crowd, RunSummary& summary, const RunLabels& labels);

    [[nodiscard]] const std::filesystem::path& path() const { return folder_; }

 private:
    static constexpr double results_interval = 2;  // s

    struct Output {
        Turn turn;
        std::unique_ptr<OutputWriter> writer;
    };

    std::filesystem::path folder_;
    std::vector<Output> outputs_;  // in the order of the list
    std::optional<ReservedSpace> reserve_;
    Stopwatch clock_;
    double next_results_ = results_interval;  // on the clock, s
};

// runs/<scene>-<UTC time>, with a number appended if that exists.
[[nodiscard]] std::filesystem::path default_run_folder(const std::string& scene_name);

}  // namespace wade::crowd
