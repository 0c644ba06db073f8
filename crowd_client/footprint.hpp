#pragma once
// The ground that a particle covers: a square as wide as its volume is, (m / rho)^(1/3), round its place.
//
// Counted in the one cell that it lies in, a particle would make even water uneven: of particles 0.46 m apart 4 or 5 fit
// into a cell of 2 m. Dealt to cells by the part of its square in each, a lattice has its depth in cells of any size.

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace wade::crowd {

// Cells of equal size, row by row (z), that cover a part of the ground.
struct GroundCells {
    double x0 = 0, z0 = 0;          // corner, m
    double step_x = 1, step_z = 1;  // m
    std::size_t columns = 1, rows = 1;

    [[nodiscard]] std::size_t cells() const { return columns * rows; }
    // The cell of a place, or cells() if it lies in none.
    [[nodiscard]] std::size_t cell_of(double x, double z) const {
        const double c = std::floor((x - x0) / step_x), r = std::floor((z - z0) / step_z);
        const bool inside = c >= 0 && c < static_cast<double>(columns) && r >= 0 && r < static_cast<double>(rows);
        return inside ? static_cast<std::size_t>(r) * columns + static_cast<std::size_t>(c) : cells();
    }
};

// Widths of the squares. Most producers have one mass for all particles, so that the last root is kept.
class Footprints {
 public:
    explicit Footprints(double density) : density_(density) {}  // kg/m3

    // m; mass: kg.
    [[nodiscard]] double width(double mass) {
        if (mass != mass_) {
            mass_ = mass;
            width_ = std::cbrt(std::max(0.0, mass) / density_);
        }
        return width_;
    }

 private:
    double density_;
    double mass_ = 0, width_ = 0;
};

// The cells of a line of `count` that an interval meets, in cells; what lies beyond the line is cut off.
struct CellRange {
    double lo, hi;
    CellRange(double middle, double width, std::size_t count)
        : lo(std::max(0.0, middle - 0.5 * width)), hi(std::min(static_cast<double>(count), middle + 0.5 * width)) {}

    [[nodiscard]] std::size_t first() const { return static_cast<std::size_t>(lo); }
    [[nodiscard]] std::size_t last() const { return std::max(first(), static_cast<std::size_t>(std::ceil(hi)) - 1); }
    // Part of the interval in a cell; of an interval without length all is in its first cell.
    [[nodiscard]] double share(std::size_t cell) const {
        const auto begin = static_cast<double>(cell);
        return hi > lo ? (std::min(hi, begin + 1) - std::max(lo, begin)) / (hi - lo) : 1;
    }
};

// Calls add(cell, share) for the cells that the square of this width round (x, z) meets. The shares sum up to 1, as what
// would lie beyond the grid is dealt to the rest; none if (x, z) is not in the grid.
template <typename Add>
void deal_footprint(const GroundCells& grid, double x, double z, double width, Add&& add) {
    if (grid.cell_of(x, z) == grid.cells()) return;
    const CellRange along((x - grid.x0) / grid.step_x, width / grid.step_x, grid.columns);
    const CellRange across((z - grid.z0) / grid.step_z, width / grid.step_z, grid.rows);
    for (std::size_t row = across.first(); row <= across.last(); ++row) {
        const double share = across.share(row);
        for (std::size_t column = along.first(); column <= along.last(); ++column) {
            add(row * grid.columns + column, share * along.share(column));
        }
    }
}

}  // namespace wade::crowd
