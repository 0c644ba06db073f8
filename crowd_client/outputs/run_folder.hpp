#pragma once
// The files of one run, kept complete up to the last step at any moment.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "crowd_client/outputs/danger.hpp"
#include "crowd_client/outputs/output_file.hpp"
#include "crowd_client/outputs/ragdoll_file.hpp"
#include "crowd_client/outputs/report.hpp"
#include "crowd_client/outputs/stopwatch.hpp"
#include "crowd_client/outputs/trajectory_file.hpp"
#include "crowd_client/outputs/water_snapshots.hpp"

namespace wade::crowd {

// What of a run is stored step by step.
struct Record {
    double water_interval = 0;  // simulated seconds between two snapshots of the water, 0 = none
    double danger_window = 0;   // over which the water is averaged for levels of danger, s; 0 = none are recorded
    bool trajectories = true;   // trajectories.sqlite
};

// Without what only pictures need: trajectories and snapshots of the water.
[[nodiscard]] Record without_pictures(const Record& record);

// How many files the folder of such a run keeps open until it is finished.
[[nodiscard]] std::size_t files_kept_open(const Scene& scene, const Record& kept);

// What a folder holds of an earlier run, in words, from its outcome.json: "s05, 50 of 50 arrived"; empty if there is none.
[[nodiscard]] std::string earlier_run(const std::filesystem::path& folder);

//   trajectories.sqlite, water.bin   grow step by step
//   ragdoll.csv                      grows step by step, absent unless the scene asks for ragdolls
//   events.jsonl                     grows with each tau command, absent if there was none
//   scene_as_played.json             the scene with these as events, rewritten as a whole with each
//   outcome.json, manifest.json      say "running" from the start, rewritten as a whole at the end
//   agents.csv                       written at the end, be it good or bad
//   danger.csv                       the same, absent unless levels of danger are recorded
//                                    outcome.json, agents.csv and danger.csv are also kept up to date by keep_results()
//   .reserve                         space for the last four, so that a disk that fills up keeps none of them out
class RunFolder {
 public:
    // Creates the folder and its first files; results of an earlier run in it are replaced.
    // Throws ConfigurationError if the folder cannot be made or written to, OutputError for a file in it.
    RunFolder(std::filesystem::path folder, const CrowdWorld& crowd, const RunLabels& labels, const Record& kept);

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

    std::filesystem::path folder_;
    std::optional<ReservedSpace> reserve_;
    std::optional<TrajectoryFile> trajectories_;
    std::optional<WaterSnapshots> water_;
    std::optional<RagdollFile> ragdolls_;
    std::optional<DangerRecord> danger_;
    std::optional<AppendFile> events_;
    std::string canonical_scene_;
    std::vector<TauEvent> played_;  // that were recorded
    std::uint64_t steps_per_snapshot_ = 0;
    Stopwatch clock_;
    double next_results_ = results_interval;  // on the clock, s
};

// runs/<scene>-<UTC time>, with a number appended if that exists.
[[nodiscard]] std::filesystem::path default_run_folder(const std::string& scene_name);

}  // namespace wade::crowd
