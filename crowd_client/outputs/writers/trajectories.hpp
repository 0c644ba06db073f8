#pragma once
// trajectories.sqlite: where everybody was after each step (trajectory_file.hpp).

#include "crowd_client/outputs/writers/trajectory_file.hpp"
#include "crowd_client/results/output_writer.hpp"

namespace wade::crowd {

class Trajectories final : public OutputWriter {
 public:
    explicit Trajectories(const OutputPlace& place)
        : file_(place.folder / "trajectories.sqlite", place.crowd.scene, {}, place.warn) {
        on_step(place.crowd, {});
    }

    void on_step(const CrowdWorld& crowd, const WaterView&) override {
        file_.write(crowd.steps, crowd.agents, crowd.active);
    }
    void finish(const RunView&) override { file_.close(); }

 private:
    TrajectoryFile file_;
};

}  // namespace wade::crowd
