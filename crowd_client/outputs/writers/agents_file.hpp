#pragma once
// agents.csv: what became of each agent. Kept up to date during the run, complete at its end, be it good or bad.

#include "crowd_client/outputs/output_file.hpp"
#include "crowd_client/outputs/output_writer.hpp"
#include "crowd_client/outputs/report.hpp"

namespace wade::crowd {

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

}  // namespace wade::crowd
