#pragma once
// manifest.json: which program, scene, seed and command made the folder; holds the resolved scene.

#include "crowd_client/outputs/output_file.hpp"
#include "crowd_client/outputs/output_writer.hpp"
#include "crowd_client/outputs/report.hpp"

namespace wade::crowd {

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
