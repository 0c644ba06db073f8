#pragma once
// ragdoll.csv: the ragdolls of a run, step by step.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "crowd_client/agents.hpp"
#include "crowd_client/results/output_file.hpp"
#include "crowd_client/results/output_writer.hpp"
#include "crowd_client/water/ragdoll.hpp"

namespace wade::crowd {

// frame,id,hip_height_m,rate_x_rad_s,rate_y_rad_s,rate_z_rad_s. frame is the step, as in
// trajectories.sqlite, and like there an agent that has arrived or died has no row from that frame on.
class RagdollFile {
 public:
    explicit RagdollFile(const std::filesystem::path& file);  // empties it; throws OutputError

    // Appends the rows of a step. Throws OutputError.
    void write(std::uint64_t step, std::span<const Ragdoll> ragdolls, const Agents& agents);

 private:
    AppendFile file_;
    std::string rows_;
};

// The output of a run.
class Ragdolls final : public OutputWriter {
 public:
    explicit Ragdolls(const OutputPlace& place) : file_(place.folder / "ragdoll.csv") {}

    void on_step(const CrowdWorld& crowd, const WaterView&) override {
        file_.write(crowd.steps, crowd.ragdolls, crowd.agents);
    }
    void finish(const RunView&) override {}

 private:
    RagdollFile file_;
};

}  // namespace wade::crowd
