#pragma once
// Outputs for animators and viewers, frame by frame: poses.csv with the pose of each person, ragdoll.csv with the
// agents that the water tumbles, and terms.csv with the terms of each person's motion.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "configs/scene/crowd.hpp"
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

// A row for each active person and frame, and one more for a person that has ended, in the first frame since then.
// Frame 0 is the start. A text table suits any program of an animator, and a killed run keeps all its frames whole.
// Numbers are rounded to thousandths, which takes 87 bytes a row instead of some 200.
class PoseFile {
 public:
    // Empties it; in a site its rows end with the height of the ground. Throws OutputError.
    PoseFile(const std::filesystem::path& file, bool in_a_site);

    // Appends the current frame of the crowd, with people that ended in a step after `after`. Throws OutputError.
    void write(std::uint64_t frame, const CrowdWorld& crowd, std::uint64_t after);

 private:
    AppendFile file_;
    std::string rows_;
};

class Poses final : public OutputWriter {
 public:
    explicit Poses(const OutputPlace& place)
        : file_(place.folder / "poses.csv", place.crowd.scene.site.has_value()),
          steps_per_frame_(steps_per_frame_at(place.crowd.scene.crowd->step_rate, place.crowd.scene.crowd->pose_rate)) {
        write(place.crowd);
    }

    void on_step(const CrowdWorld& crowd, const WaterView&) override {
        if (crowd.steps % steps_per_frame_ == 0) write(crowd);
    }
    // Also writes the last poses of all, unless the file takes no more.
    void finish(const RunView& run) override {
        if (is_whole_ && run.crowd.steps > last_step_) write(run.crowd);
    }

 private:
    void write(const CrowdWorld& crowd) {
        is_whole_ = false;
        file_.write(next_frame_++, crowd, last_step_);
        is_whole_ = true;
        last_step_ = crowd.steps;
    }

    PoseFile file_;
    std::uint64_t steps_per_frame_;
    std::uint64_t next_frame_ = 0, last_step_ = 0;
    bool is_whole_ = true;  // nothing went wrong so far
};

// terms.csv: a row for each person that was active in the last part of the step, with the terms of its velocity from
// Eq. 5 to 9 and from the body. Empty if the response does not use a term.
class TermsFile final : public OutputWriter {
 public:
    explicit TermsFile(const OutputPlace& place);

    void on_step(const CrowdWorld& crowd, const WaterView& water) override;  // throws OutputError
    void finish(const RunView&) override {}

 private:
    AppendFile file_;
    std::string rows_;
    std::uint64_t steps_between_, next_frame_ = 0;
};

}  // namespace wade::crowd
