#pragma once
// One output of a run: a file of the run folder, or several that belong together.
//
//   make --> on_step, on_step, ... keep, on_step, ... on_event, ... --> finish

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "crowd_client/crowd_world.hpp"
#include "crowd_client/results/run_labels.hpp"
#include "crowd_client/results/run_summary.hpp"

namespace wade::crowd {

class DangerRecord;

// Parts of a run that are stored step by step.
struct Record {
    double water_interval = 0;  // simulated seconds between two snapshots of the water, 0 = none
    double danger_window = 0;   // averaging time of the water for levels of danger, s; 0 = none are recorded
    bool trajectories = true;   // trajectories.sqlite
    double terms_interval = 0;  // between two rows of each person's terms of the equations, s; 0 = none
    double path_interval = 0;   // simulated seconds of paths that are written at once, 0 = each frame by itself
};

// Returns the record without outputs for pictures alone: trajectories and snapshots of the water.
[[nodiscard]] inline Record without_pictures(const Record& record) {
    return {.water_interval = 0, .danger_window = record.danger_window, .trajectories = false};
}

// Input for making an output.
struct OutputPlace {
    std::filesystem::path folder;  // exists and can be written to
    const CrowdWorld& crowd;       // before its first step
    const RunLabels& labels;
    Record kept;
    std::shared_ptr<DangerRecord> danger;          // null unless levels of danger are recorded
    std::function<void(const std::string&)> warn;  // a sentence for the user; never empty
};

// The current state of a run.
struct RunView {
    const CrowdWorld& crowd;
    const RunSummary& summary;
    const RunLabels& labels;
};

// All members throw OutputError for a failed write; earlier output stays whole.
class OutputWriter {
 public:
    OutputWriter() = default;
    OutputWriter(const OutputWriter&) = delete;
    OutputWriter& operator=(const OutputWriter&) = delete;
    virtual ~OutputWriter() = default;

    // After each step; water: that of the step.
    virtual void on_step(const CrowdWorld&, const WaterView&) {}

    // After a frame of the water, every few seconds of wall time: writes current results, in case the run is killed.
    virtual void keep(const RunView&) {}

    // A change of tau that the scene does not have, before its first step.
    virtual void on_event(const TauEvent&) {}

    // At the end of the run, good or bad. Once more if a later output fails, so that it can report this.
    virtual void finish(const RunView&) = 0;

    // Returns the disk space that finish() needs at most, bytes; it is kept free from the start.
    [[nodiscard]] virtual std::size_t bytes_at_end() const { return 0; }
};

}  // namespace wade::crowd
