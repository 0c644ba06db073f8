#pragma once
// The points of a regular grid that lie in a polygon, row by row.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "configs/scene/site.hpp"

namespace wade {

// Points ((column + 0.5) dx, (row + 0.5) dz), m.
struct PointGrid {
    int columns = 1, rows = 1;
    double dx = 1, dz = 1;

    [[nodiscard]] MapPoint at(int column, int row) const { return {(column + 0.5) * dx, (row + 0.5) * dz}; }
};

// Calls visit(column, row) for each point of the grid with contains(polygon, point). The time grows with the points and
// with the rows that each edge crosses, not with points times edges.
template <typename Visit>
void for_each_point_in(const MapPolygon& polygon, const PointGrid& grid, Visit&& visit) {
    std::vector<std::pair<MapPoint, MapPoint>> edges;
    for (const MapLine& ring : polygon.rings) {
        for (std::size_t k = 0, last = ring.size() - 1; k < ring.size(); last = k++)
            edges.emplace_back(ring[last], ring[k]);
    }
    const auto lower = [](const auto& edge) { return std::min(edge.first.z, edge.second.z); };
    std::sort(edges.begin(), edges.end(), [&](const auto& a, const auto& b) { return lower(a) < lower(b); });
    std::vector<std::size_t> active;
    std::vector<double> crossings;
    std::size_t next = 0;
    for (int row = 0; row < grid.rows; ++row) {
        const double z = grid.at(0, row).z;
        while (next < edges.size() && lower(edges[next]) <= z) active.push_back(next++);
        std::erase_if(active, [&](std::size_t e) { return std::max(edges[e].first.z, edges[e].second.z) < z; });
        crossings.clear();
        for (const std::size_t e : active) {
            const auto& [a, b] = edges[e];
            if ((a.z > z) != (b.z > z)) crossings.push_back(a.x + (b.x - a.x) * (z - a.z) / (b.z - a.z));
        }
        std::sort(crossings.begin(), crossings.end());
        // A point lies inside if an odd number of crossings lies beyond it.
        for (std::size_t k = 0; k + 1 < crossings.size(); k += 2) {
            const double first = std::clamp(crossings[k] / grid.dx - 1, 0.0, static_cast<double>(grid.columns));
            for (int column = static_cast<int>(first); column < grid.columns; ++column) {
                const double x = grid.at(column, row).x;
                if (x >= crossings[k + 1]) break;
                if (x >= crossings[k]) visit(column, row);
            }
        }
    }
}

}  // namespace wade
