#pragma once
// outcome.json, agents.csv and manifest.json: functions for their texts, and their output classes.

#include <string>

#include "crowd_client/outputs/writers/danger.hpp"
#include "crowd_client/results/output_file.hpp"
#include "crowd_client/results/output_writer.hpp"

namespace wade::crowd {

// Returns the text of outcome.json; unknown values are null.
[[nodiscard]] std::string outcome_json(const CrowdWorld& crowd, const RunSummary& summary, const RunLabels& labels);

// agents.csv: id,group,outcome,time_s,x_m,z_m,tau,mass_kg,path_length_m,max_depth_m,max_dv_m2_s,mean_depth_m,mean_dv_m2_s,state,
// height_m,mean_tau,worst_state,age,skill,start_x_m,start_z_m,off_feet_s,door_depth_m,adrift_s,exposure_s,drift_end,can_swim.
// Numbers have as many digits as it takes to read back the same bits. time_s: of arrival, of death or of the last step. With a record of danger,
// its columns follow: the largest level that the agent met, and the time in each.
[[nodiscard]] std::string agents_csv(const CrowdWorld& crowd, const DangerRecord* danger = nullptr);

// A row of crowds.csv behind the crowd's name: seed,status,agents,arrived,dead,active,sheltered,indoors,upper_floor,
// last_arrival_s,message.
[[nodiscard]] std::string crowds_csv_row(const CrowdWorld& crowd, const RunSummary& summary);

// manifest.json: which program, scene, seed and command made the folder; holds the resolved scene.
[[nodiscard]] std::string manifest_json(const CrowdWorld& crowd, const RunSummary& summary, const RunLabels& labels);

// outcome.json, which says "running" from the start.
class OutcomeFile final : public OutputWriter {
 public:
    explicit OutcomeFile(const OutputPlace& place) : file_(place.folder / "outcome.json") {
        write_whole_file(file_, outcome_json(place.crowd, RunSummary{}, place.labels));
    }

    void keep(const RunView& run) override {
        write_whole_file(file_, outcome_json(run.crowd, run.summary, run.labels));
    }
    void finish(const RunView& run) override { keep(run); }
    [[nodiscard]] std::size_t bytes_at_end() const override { return 32768; }

 private:
    std::filesystem::path file_;
};

// agents.csv, kept up to date during the run, complete at its end, be it good or bad.
class AgentsFile final : public OutputWriter {
 public:
    explicit AgentsFile(const OutputPlace& place)
        : file_(place.folder / "agents.csv"), danger_(place.danger), agents_(place.crowd.agents.size()) {}

    void keep(const RunView& run) override { write_whole_file(file_, agents_csv(run.crowd, danger_.get())); }
    void finish(const RunView& run) override { keep(run); }
    // Twice the length of a line for each.
    [[nodiscard]] std::size_t bytes_at_end() const override { return 400 * agents_; }

 private:
    std::filesystem::path file_;
    std::shared_ptr<DangerRecord> danger_;
    std::size_t agents_;
};

// manifest.json, from the start.
class ManifestFile final : public OutputWriter {
 public:
    explicit ManifestFile(const OutputPlace& place)
        : file_(place.folder / "manifest.json"), scene_bytes_(place.labels.canonical_scene.size()) {
        write_whole_file(file_, manifest_json(place.crowd, RunSummary{}, place.labels));
    }

    void finish(const RunView& run) override {
        write_whole_file(file_, manifest_json(run.crowd, run.summary, run.labels));
    }
    [[nodiscard]] std::size_t bytes_at_end() const override { return 2 * scene_bytes_ + 32768; }

 private:
    std::filesystem::path file_;
    std::size_t scene_bytes_;
};

}  // namespace wade::crowd
