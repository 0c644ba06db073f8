#pragma once
// danger.csv: the levels of danger that the water reached, cell by cell. Keeps the record up to date for others, too.

#include "crowd_client/outputs/output_file.hpp"
#include "crowd_client/outputs/output_writer.hpp"
#include "crowd_client/outputs/writers/danger.hpp"

namespace wade::crowd {

class DangerFile final : public OutputWriter {
 public:
    explicit DangerFile(const OutputPlace& place) : file_(place.folder / "danger.csv"), record_(place.danger) {}

    void on_step(const CrowdWorld& crowd, const WaterView& water) override {
        record_->add(crowd.agents, crowd.active, water);
    }
    void keep(const RunView&) override { write_whole_file(file_, danger_csv(*record_)); }
    void finish(const RunView& run) override {
        record_->close();
        keep(run);
    }
    // Twice the length of a line for each cell.
    [[nodiscard]] std::size_t bytes_at_end() const override { return 400 * record_->cells().size(); }

 private:
    std::filesystem::path file_;
    std::shared_ptr<DangerRecord> record_;
};

}  // namespace wade::crowd
