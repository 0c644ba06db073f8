#pragma once
// ragdoll.csv: the ragdolls of a run, frame by frame of the paths.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "configs/scene/scene_frames.hpp"
#include "crowd_client/agents.hpp"
#include "crowd_client/results/output_file.hpp"
#include "crowd_client/results/output_writer.hpp"
#include "crowd_client/water/ragdoll.hpp"

namespace wade::crowd {

// frame,id,hip_height_m,rate_x_rad_s,rate_y_rad_s,rate_z_rad_s. frame as in trajectories.sqlite; an agent that has arrived or
// died has no row from that frame on.
class RagdollFile {
 public:
    explicit RagdollFile(const std::filesystem::path& file);  // empties it; throws OutputError

    // Appends the rows of a frame. Throws OutputError.
    void write(std::uint64_t frame, std::span<const Ragdoll> ragdolls, const Agents& agents);

 private:
    AppendFile file_;
    std::string rows_;
};

// The output of a run.
class Ragdolls final : public OutputWriter {
 public:
    explicit Ragdolls(const OutputPlace& place)
        : file_(place.folder / "ragdoll.csv"), steps_per_frame_(steps_per_path_frame(place.crowd.scene)) {}

    void on_step(const CrowdWorld& crowd, const WaterView&) override {
        if (crowd.steps % steps_per_frame_ != 0) return;
        file_.write(crowd.steps / steps_per_frame_, crowd.ragdolls, crowd.agents);
    }
    void finish(const RunView&) override {}

 private:
    RagdollFile file_;
    std::uint64_t steps_per_frame_;
};

}  // namespace wade::crowd
