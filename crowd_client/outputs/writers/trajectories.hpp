#pragma once
// trajectories.sqlite: positions of all agents, frame by frame (trajectory_file.hpp).

#include <algorithm>
#include <cmath>

#include "configs/scene/scene_frames.hpp"
#include "crowd_client/outputs/writers/trajectory_file.hpp"
#include "crowd_client/results/output_writer.hpp"

namespace wade::crowd {

class Trajectories final : public OutputWriter {
 public:
    explicit Trajectories(const OutputPlace& place)
        : steps_per_frame_(steps_per_path_frame(place.crowd.scene)),
          file_(place.folder / "trajectories.sqlite", place.crowd.scene, limits_of(place), place.warn) {
        write(place.crowd);
    }

    void on_step(const CrowdWorld& crowd, const WaterView&) override {
        if (crowd.steps % steps_per_frame_ == 0) write(crowd);
    }
    // Also writes the last positions of all agents, unless the file takes no more.
    void finish(const RunView& run) override {
        if (is_whole_ && run.crowd.steps > last_step_) write(run.crowd);
        file_.close();
    }

 private:
    [[nodiscard]] TrajectoryLimits limits_of(const OutputPlace& place) const {
        const double frames = place.kept.path_interval / (place.crowd.dt * static_cast<double>(steps_per_frame_));
        return {.frames_at_once = static_cast<std::size_t>(std::max(1.0, std::round(frames)))};
    }
    void write(const CrowdWorld& crowd) {
        is_whole_ = false;
        file_.write(next_frame_++, crowd.agents, last_step_);
        is_whole_ = true;
        last_step_ = crowd.steps;
    }

    std::uint64_t steps_per_frame_;
    TrajectoryFile file_;
    std::uint64_t next_frame_ = 0, last_step_ = 0;
    bool is_whole_ = true;  // nothing went wrong so far
};

}  // namespace wade::crowd
