#include "fluid_server/shallow_water/grid.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/intervals.hpp"
#include "configs/scene/obstacle.hpp"

namespace wade::fluid::shallow_water {

namespace {

double height_at(const std::vector<BedPoint>& points, double x) {
    if (points.empty()) return 0;
    if (x <= points.front().x) return points.front().y;
    for (std::size_t i = 1; i < points.size(); ++i) {
        const BedPoint &a = points[i - 1], &b = points[i];
        if (x <= b.x) return a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x);
    }
    return points.back().y;
}

// Of the straight lines between the points, by trapezia: exact.
double mean_height(const std::vector<BedPoint>& points, const Interval& x) {
    double sum = 0;
    BedPoint last{x.lo, height_at(points, x.lo)};
    const auto up_to = [&](const BedPoint& next) {
        sum += 0.5 * (last.y + next.y) * (next.x - last.x);
        last = next;
    };
    for (const BedPoint& point : points) {
        if (x.lo < point.x && point.x < x.hi) up_to(point);
    }
    up_to({x.hi, height_at(points, x.hi)});
    return sum / x.length();
}

Interval cell_of(const Interval& extent, std::size_t n, std::size_t i) {
    const double size = extent.length() / static_cast<double>(n);
    return {extent.lo + static_cast<double>(i) * size, extent.lo + static_cast<double>(i + 1) * size};
}

bool holds_centre(const Interval& box, const Interval& cell) {
    const double centre = 0.5 * (cell.lo + cell.hi);
    return box.lo <= centre && centre < box.hi;
}

// Calls body(place, x, z) for each cell, x and z its extent.
template <typename Body>
void for_each_cell(const Grid& grid, Body&& body) {
    for (std::size_t k = 0; k < grid.nz; ++k) {
        const Interval z = cell_of(grid.z, grid.nz, k);
        for (std::size_t i = 0; i < grid.nx; ++i) {
            body(grid.row(static_cast<std::ptrdiff_t>(k)) + i, cell_of(grid.x, grid.nx, i), z);
        }
    }
}

}  // namespace

Grid make_grid(const Scene& scene) {
    Grid grid;
    static_cast<MapCells&>(grid) = map_cells(scene.channel->x, scene.channel->z, scene.fluid->shallow_water.cell_size);
    grid.stride = line_values + whole_lines(grid.nx + Grid::ghosts);
    return grid;
}

Bed make_bed(const Scene& scene, const Grid& grid) {
    Bed bed;
    bed.height.assign(grid.stored(), 0);
    if (!scene.obstacles.empty()) bed.obstacle.assign(grid.stored(), 0);
    for_each_cell(grid, [&](std::size_t c, const Interval& x, const Interval& z) {
        bed.height[c] = mean_height(scene.channel->bed_points, x);
        for (const Obstacle& obstacle : scene.obstacles) {
            if (!holds_centre(obstacle.x, x) || !holds_centre(obstacle.z, z)) continue;
            bed.height[c] = std::max(bed.height[c], obstacle.height);
            bed.obstacle[c] = 1;
        }
    });
    bed.level = std::all_of(bed.height.begin(), bed.height.end(), [](double b) { return b == 0; });
    return bed;
}

Water initial_water(const Scene& scene, const Grid& grid, const Bed& bed) {
    Water water(grid);
    if (scene.site) return water;  // its bed is not known before its walls: see set_openings()
    const Channel& channel = scene.channel;
    const bool river = channel.flow != Flow::closed && channel.initial_river == InitialRiver::filled;
    for_each_cell(grid, [&](std::size_t c, const Interval& x, const Interval& z) {
        if (river) {
            water.h[c] = std::max(0.0, channel.depth - bed.height[c]);
            water.qx[c] = -channel.velocity * water.h[c];
        }
        for (const WaterBlock& block : channel.water_blocks) {
            const double share = common_length(block.x, x) * common_length(block.z, z) / grid.cell_area();
            const double h = share * std::max(0.0, block.depth - bed.height[c]);
            water.h[c] += h;
            water.qx[c] += h * block.velocity[0];
            water.qz[c] += h * block.velocity[2];
        }
    });
    return water;
}

}  // namespace wade::fluid::shallow_water
