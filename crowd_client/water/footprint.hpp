#pragma once
// The ground that a particle covers: the rectangle of its column, or a square around its position as wide as its
// volume, (m / rho)^(1/3).
//
// If a particle counted in its own cell alone, even water would look uneven: 4 or 5 particles 0.46 m apart fit into a
// cell of 2 m. Each cell therefore gets the part of the square in it, so that a lattice has its depth in cells of any
// size. The outermost cells are an exception, because the part beyond the grid is dealt to the rest.

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "configs/numbers/portable.hpp"
#include "crowd_client/equations.hpp"
#include "crowd_client/markers/ground_cells.hpp"

namespace wade::crowd {

// The part of a line of cells that an interval covers, in cells, at least in part within the line.
struct CellRange {
    double lo, hi;
    CellRange(double middle, double width, std::size_t cells)
        : lo(std::max(0.0, middle - 0.5 * width)), hi(std::min(static_cast<double>(cells), middle + 0.5 * width)) {}

    [[nodiscard]] std::size_t first() const { return static_cast<std::size_t>(lo); }
    [[nodiscard]] std::size_t last() const {
        return std::max(first() + 1, static_cast<std::size_t>(std::ceil(hi))) - 1;
    }
    // Part of the range in a cell of several that it meets.
    [[nodiscard]] double share(std::size_t cell) const {
        const auto begin = static_cast<double>(cell);
        return (std::min(hi, begin + 1) - std::max(lo, begin)) / (hi - lo);
    }
};

// Deals particles to the cells of a grid.
class Footprints {
 public:
    // density: of rest, kg/m3; column: width of the columns, m, 0 for points
    Footprints(const GroundCells& grid, double density, const Vector2d& column)
        : grid_(grid),
          density_(density),
          per_x_(1 / grid.step_x),
          per_z_(1 / grid.step_z),
          columns_(column.x() * per_x_),
          rows_(column.y() * per_z_),
          fixed_(column.x() > 0) {}

    // Calls add(cell, share, own) for the cells that the square of a particle at (x, z), m, of this mass, kg, meets;
    // own: the cell of its position. The shares sum up to 1. Makes no call for a particle outside the grid.
    template <typename Add>
    void deal(double x, double z, double mass, Add&& add) {
        const double column = (x - grid_.x0) * per_x_, row = (z - grid_.z0) * per_z_;
        if (!(column >= 0 && column < static_cast<double>(grid_.columns))) return;
        if (!(row >= 0 && row < static_cast<double>(grid_.rows))) return;
        if (!fixed_ && mass != mass_) find_width(mass);
        const CellRange along(column, columns_, grid_.columns), across(row, rows_, grid_.rows);
        const std::size_t own = static_cast<std::size_t>(row) * grid_.columns + static_cast<std::size_t>(column);
        const std::size_t left = along.first(), right = along.last(), low = across.first(), high = across.last();
        for (std::size_t r = low; r <= high; ++r) {
            const double of_row = low == high ? 1 : across.share(r);
            for (std::size_t c = left; c <= right; ++c) {
                add(r * grid_.columns + c, left == right ? of_row : of_row * along.share(c), own);
            }
        }
    }

 private:
    // Most producers have one mass for all particles, so that the last root is kept. The width of a square is limited
    // to some cells, so that particles of any mass take a bounded time.
    void find_width(double mass) {
        constexpr double widest = 8;
        mass_ = mass;
        const double width = cube_root(std::max(0.0, mass) / density_);
        columns_ = std::min(width * per_x_, widest);
        rows_ = std::min(width * per_z_, widest);
    }

    const GroundCells& grid_;
    double density_;
    double per_x_, per_z_;   // cells a metre
    double mass_ = 0;        // kg
    double columns_, rows_;  // width of its rectangle, in cells
    bool fixed_;             // for all particles
};

}  // namespace wade::crowd
