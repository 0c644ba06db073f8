#pragma once
// water.bin: the depth of the water on a grid every few seconds, for pictures.
//
// Little-endian. Header, 64 bytes: "WADEWAT1", u32 columns, u32 rows, f64 cell size (m), f64 x and z of the grid's
// corner (m), f64 largest depth that can be stored (m), zeros. Then one record a snapshot: u64 step of the crowd, f64 time (s),
// columns * rows u16, row by row (z), depth in millimetres: volume of the particles over the area of the cell, each dealt to
// the cells that it covers (footprint.hpp).

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "configs/scene/scene.hpp"
#include "crowd_client/markers/ground_cells.hpp"
#include "crowd_client/outputs/output_file.hpp"
#include "crowd_client/water/water_view.hpp"

namespace wade::crowd {

class WaterSnapshots {
 public:
    // Cells of 0.5 m, or larger where the particles or the number of cells ask for it. Throws OutputError.
    WaterSnapshots(const std::filesystem::path& file, const Scene& scene);

    // Appends one record. Throws OutputError.
    void write(std::uint64_t step, double time, const WaterView& water);

 private:
    AppendFile file_;
    GroundCells grid_;
    double rest_density_;
    std::vector<double> mass_;
    std::string record_;
};

}  // namespace wade::crowd
