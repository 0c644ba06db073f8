#pragma once
// outcome.json: how the run went. Says "running" from the start.

#include "crowd_client/outputs/output_file.hpp"
#include "crowd_client/outputs/output_writer.hpp"
#include "crowd_client/outputs/report.hpp"

namespace wade::crowd {

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

}  // namespace wade::crowd
