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

// How many files the folder of such a run keeps open until it is finished.
[[nodiscard]] std::size_t files_kept_open(const Scene& scene, const Record& kept);

// Raises the limit of open files of this process, so that crowds that keep as many open each as `per_crowd` says have
// room: up to five each, where the usual limit of 1024 would end at some 200 crowds.
// Throws ConfigurationError if even the largest limit that the process may have is too low.
void allow_open_files(std::span<const std::size_t> per_crowd);

// What a folder holds of an earlier run, in words, from its outcome.json: "s05, 50 of 50 arrived"; empty if there is none.
[[nodiscard]] std::string earlier_run(const std::filesystem::path& folder);

// All outputs that a run asks for, told together (output_list.hpp). Beside them, until the run is finished, there is
// `.reserve`: space for the last files, so that a disk that fills up keeps none of them out.
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

    // Writes the results as they stand, so that a killed run loses little of who arrived: every two seconds of wall time, or
    // as seldom as makes it a hundredth of it. Throws OutputError.
    void keep_results(const CrowdWorld& crowd, const RunSummary& summary, const RunLabels& labels);

    // Logs an event that was not in the scene, so that the scene as it was played repeats the run. Throws OutputError.
    void record_event(const TauEvent& event);

    // Writes the final files. All are tried, the first error is thrown at the end and stands in the summary, and in
    // those files that can be written.
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
