#pragma once
// Cells of a regular grid over the map, and those that shapes cover.

#include <cstddef>
#include <vector>

#include "configs/scene/interval.hpp"
#include "configs/scene/site.hpp"

namespace wade {

struct MapCells {
    Interval x, z;               // extent, m
    std::size_t nx = 0, nz = 0;  // cells along x and along z
    double dx = 0, dz = 0;       // m

    [[nodiscard]] std::size_t cells() const { return nx * nz; }
    // cell: k * nx + i.
    [[nodiscard]] MapPoint centre_of(std::size_t cell) const {
        const std::size_t i = cell % nx, k = cell / nx;
        return {x.lo + (static_cast<double>(i) + 0.5) * dx, z.lo + (static_cast<double>(k) + 0.5) * dz};
    }
};

// Returns cells as near to `size`, m, as the extent allows, at least one along each axis.
[[nodiscard]] MapCells map_cells(const Interval& x, const Interval& z, double size);

// Returns the cells, k * nx + i, that a line crosses or touches, in ascending order.
[[nodiscard]] std::vector<std::size_t> cells_on(const MapCells& grid, const MapLine& line);

// Cells of one row.
struct CellSpan {
    std::size_t first = 0, last = 0;
};

// Returns the cells with their centre in a polygon, in ascending order; a centre on an edge is outside.
[[nodiscard]] std::vector<CellSpan> cells_in(const MapCells& grid, const MapPolygon& polygon);

}  // namespace wade
