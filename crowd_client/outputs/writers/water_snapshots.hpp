#pragma once
// water.bin: the depth of the water on a grid every few seconds, for pictures.
//
// Little-endian. Header, 64 bytes: "WADEWAT1", u32 columns, u32 rows, f64 cell size (m), f64 x and z of the grid's
// corner (m), f64 largest depth that can be stored (m), zeros. Then one record a snapshot: u64 step of the crowd, f64 time (s),
// columns * rows u16, row by row (z), depth in millimetres: volume of the particles over the area of the cell, each dealt to
// the cells that it covers (footprint.hpp).

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "configs/scene/scene.hpp"
#include "crowd_client/markers/ground_cells.hpp"
#include "crowd_client/results/output_file.hpp"
#include "crowd_client/results/output_writer.hpp"
#include "crowd_client/water/water_view.hpp"

namespace wade::crowd {

class WaterSnapshots {
 public:
    // Uses cells of 0.5 m, or larger ones if the particles or the number of cells require it. Throws OutputError.
    WaterSnapshots(const std::filesystem::path& file, const Scene& scene);

    // Appends one record. Throws OutputError.
    void write(std::uint64_t step, double time, const WaterView& water);

 private:
    AppendFile file_;
    GroundCells grid_;
    double rest_density_;
    bool has_columns_;  // the water of a site
    std::vector<double> mass_;
    std::string record_;
};

// The output of a run.
class WaterPictures final : public OutputWriter {
 public:
    explicit WaterPictures(const OutputPlace& place)
        : file_(place.folder / "water.bin", place.crowd.scene),
          steps_between_(
              static_cast<std::uint64_t>(std::max(1LL, std::llround(place.kept.water_interval / place.crowd.dt)))) {}

    // Also writes after the first and the last step, so that any time of the run has a picture at most one interval
    // away.
    void on_step(const CrowdWorld& crowd, const WaterView& water) override {
        const bool due = crowd.steps == 1 || crowd.steps % steps_between_ == 0;
        if (due || run_is_over(crowd)) file_.write(crowd.steps, time_of(crowd), water);
    }
    void finish(const RunView&) override {}

 private:
    WaterSnapshots file_;
    std::uint64_t steps_between_;
};

}  // namespace wade::crowd
