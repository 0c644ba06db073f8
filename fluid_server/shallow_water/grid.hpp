#pragma once
// The grid of the shallow-water equations: cells of the channel's ground, and the water in them.
//
//      z ^  row nz - 1   . . | o o o o o | . .      A row runs along x. Two ghost cells lie at each end of a row and two
//        |     ...       . . | o o o o o | . .      ghost rows on each side; what they hold says what lies beyond the
//        |  row 0        . . | o o o o o | . .      border (boundary.hpp).
//        +-----------> x

#include <cstddef>
#include <vector>

#include "configs/scene/interval.hpp"
#include "configs/scene/map_cells.hpp"
#include "configs/scene/scene.hpp"
#include "fluid_server/shallow_water/row_memory.hpp"

namespace wade::fluid::shallow_water {

// The cells of the channel, or of a site, as they lie in memory.
struct Grid : MapCells {
    static constexpr std::size_t ghosts = 2;

    std::size_t stride = 0;  // of a row, ghosts included

    [[nodiscard]] double cell_area() const { return dx * dz; }
    [[nodiscard]] std::size_t stored() const { return stride * (nz + 2 * ghosts); }
    // x of the face below cell i of a row, m.
    [[nodiscard]] double face_x(std::size_t i) const { return x.lo + static_cast<double>(i) * dx; }
    // Place of the first cell of row k, -2 <= k < nz + 2; the ghosts of the row are at -2, -1, nx and nx + 1 from there.
    [[nodiscard]] std::size_t row(std::ptrdiff_t k) const {
        return static_cast<std::size_t>(k + std::ptrdiff_t{ghosts}) * stride + line_values;
    }
};

// Cells as near to fluid.shallow_water.cell_size as channel length and width allow, at least one each way.
[[nodiscard]] Grid make_grid(const Scene& scene);

// The conserved quantities, one value a cell.
struct Water {
    RowMemory h;       // depth, m
    RowMemory qx, qz;  // h u and h v: depth times the depth-averaged velocity, m^2/s

    explicit Water(const Grid& grid) : h(grid.stored(), 0), qx(grid.stored(), 0), qz(grid.stored(), 0) {}
};

// What the bed is, one value a cell.
struct Bed {
    RowMemory height;     // b, m: the mean of bed_points over the cell, or the top of an obstacle
    RowMemory obstacle;   // 1 in cells with the centre in an obstacle, else 0; empty if there is none
    bool level = false;   // of a channel: whether all heights are 0
    RowMemory ground;     // of a site: height as it is given; b of cells that are stepped as one is their mean
    RowMemory n_squared;  // of a site: square of Manning's n, s^2/m^(2/3); empty: the same everywhere
};
[[nodiscard]] Bed make_bed(const Scene& scene, const Grid& grid);

// The water of the scene at t = 0: its river or its blocks, each cell with its mean over the cell.
[[nodiscard]] Water initial_water(const Scene& scene, const Grid& grid, const Bed& bed);

}  // namespace wade::fluid::shallow_water
