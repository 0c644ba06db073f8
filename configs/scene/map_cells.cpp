#include "configs/scene/map_cells.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "configs/scene/intervals.hpp"

namespace wade {

MapCells map_cells(const Interval& x, const Interval& z, double size) {
    MapCells grid{x, z, cells_along(x, size), cells_along(z, size), 0, 0};
    grid.dx = x.length() / static_cast<double>(grid.nx);
    grid.dz = z.length() / static_cast<double>(grid.nz);
    return grid;
}

std::vector<std::size_t> cells_on(const MapCells& grid, const MapLine& line) {
    std::vector<std::size_t> cells;
    const auto add = [&](double x, double z) {
        const double i = std::floor((x - grid.x.lo) / grid.dx), k = std::floor((z - grid.z.lo) / grid.dz);
        if (i < 0 || k < 0 || i >= static_cast<double>(grid.nx) || k >= static_cast<double>(grid.nz)) return;
        cells.push_back(static_cast<std::size_t>(k) * grid.nx + static_cast<std::size_t>(i));
    };
    for (std::size_t n = 1; n < line.size(); ++n) {
        const MapPoint &a = line[n - 1], &b = line[n];
        // In the middle between every two crossings of faces it lies in a cell; a line on the far edge lies in the last one.
        std::vector<double> parts{0, 1};
        const auto crossings = [&](double from, double to, double lo, double size) {
            if (from == to) return;
            const double first = (std::min(from, to) - lo) / size, last = (std::max(from, to) - lo) / size;
            for (double f = std::ceil(first); f <= last; ++f) parts.push_back((lo + f * size - from) / (to - from));
        };
        crossings(a.x, b.x, grid.x.lo, grid.dx);
        crossings(a.z, b.z, grid.z.lo, grid.dz);
        std::sort(parts.begin(), parts.end());
        for (std::size_t p = 1; p < parts.size(); ++p) {
            const double t = 0.5 * (parts[p - 1] + parts[p]);
            const double x = a.x + t * (b.x - a.x), z = a.z + t * (b.z - a.z);
            add(x >= grid.x.hi ? x - 0.5 * grid.dx : x, z >= grid.z.hi ? z - 0.5 * grid.dz : z);
        }
    }
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    return cells;
}

std::vector<CellSpan> cells_in(const MapCells& grid, const MapPolygon& polygon) {
    constexpr double edge = 1e-6;                 // of a cell; polygons with a common edge have no common centre
    std::vector<std::pair<double, double>> cuts;  // row and x of the centre lines that edges cross, in cells
    const auto rows = static_cast<double>(grid.nz), columns = static_cast<double>(grid.nx);
    for (const MapLine& ring : polygon.rings) {
        for (std::size_t n = 0, last = ring.size() - 1; n < ring.size(); last = n++) {
            const double x = (ring[last].x - grid.x.lo) / grid.dx - 0.5, z = (ring[last].z - grid.z.lo) / grid.dz - 0.5,
                         to_x = (ring[n].x - grid.x.lo) / grid.dx - 0.5, to_z = (ring[n].z - grid.z.lo) / grid.dz - 0.5;
            for (double k = std::max(0.0, std::ceil(std::min(z, to_z))); k < std::min(rows, std::max(z, to_z)); ++k)
                cuts.emplace_back(k, x + (to_x - x) * (k - z) / (to_z - z));
        }
    }
    std::sort(cuts.begin(), cuts.end());  // an even number in each row
    std::vector<CellSpan> spans;
    for (std::size_t n = 0; n + 1 < cuts.size(); n += 2) {
        const double first = std::max(0.0, std::ceil(cuts[n].second + edge)),
                     last = std::min(columns - 1, std::floor(cuts[n + 1].second - edge));
        const std::size_t row = static_cast<std::size_t>(cuts[n].first) * grid.nx;
        if (first <= last)
            spans.push_back({row + static_cast<std::size_t>(first), row + static_cast<std::size_t>(last)});
    }
    return spans;
}

}  // namespace wade
