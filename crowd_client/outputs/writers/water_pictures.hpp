#pragma once
// water.bin: the depth of the water every few seconds (water_snapshots.hpp).

#include <algorithm>
#include <cmath>

#include "crowd_client/outputs/output_writer.hpp"
#include "crowd_client/outputs/writers/water_snapshots.hpp"

namespace wade::crowd {

class WaterPictures final : public OutputWriter {
 public:
    explicit WaterPictures(const OutputPlace& place)
        : file_(place.folder / "water.bin", place.crowd.scene),
          steps_between_(
              static_cast<std::uint64_t>(std::max(1LL, std::llround(place.kept.water_interval / place.crowd.dt)))) {}

    // After the first and the last step, too, so that any time of the run has a picture at most one interval away.
    void on_step(const CrowdWorld& crowd, const WaterView& water) override {
        const bool due = crowd.steps == 1 || crowd.steps % steps_between_ == 0;
        if (due || run_is_over(crowd)) file_.write(crowd.steps, static_cast<double>(crowd.steps) * crowd.dt, water);
    }
    void finish(const RunView&) override {}

 private:
    WaterSnapshots file_;
    std::uint64_t steps_between_;
};

}  // namespace wade::crowd
