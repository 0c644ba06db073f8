#pragma once
// Cells of any size, without a border, that divide a part of the ground for output files. The crowd searches for
// markers and water in cells of 2 x 2 m that reach beyond the world (ground_grid.hpp).

#include <cmath>
#include <cstddef>

namespace wade::crowd {

// Row by row (z).
struct GroundCells {
    double x0 = 0, z0 = 0;          // corner, m
    double step_x = 1, step_z = 1;  // m
    std::size_t columns = 1, rows = 1;

    [[nodiscard]] std::size_t cells() const { return columns * rows; }
    // Returns the cell of a position, or cells() if it lies in none.
    [[nodiscard]] std::size_t cell_of(double x, double z) const {
        const double c = std::floor((x - x0) / step_x), r = std::floor((z - z0) / step_z);
        const bool inside = c >= 0 && c < static_cast<double>(columns) && r >= 0 && r < static_cast<double>(rows);
        return inside ? static_cast<std::size_t>(r) * columns + static_cast<std::size_t>(c) : cells();
    }
};

}  // namespace wade::crowd
