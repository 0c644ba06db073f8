#include "fluid_server/shallow_water/site/site_ground.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "fluid_server/shallow_water/site/map_cover.hpp"

namespace wade::fluid::shallow_water {

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

// Calls body(place in memory, number k * nx + i, centre) for each cell.
template <typename Body>
void for_each_centre(const Grid& grid, Body&& body) {
    for (std::size_t k = 0; k < grid.nz; ++k) {
        for (std::size_t i = 0; i < grid.nx; ++i) {
            const MapPoint centre{grid.x.lo + (static_cast<double>(i) + 0.5) * grid.dx,
                                  grid.z.lo + (static_cast<double>(k) + 0.5) * grid.dz};
            body(grid.row(static_cast<std::ptrdiff_t>(k)) + i, k * grid.nx + i, centre);
        }
    }
}

// Raster cells, or centres of them, along one axis.
struct Run {
    std::ptrdiff_t first = 0, last = -1;
};

Run centres_within(double lo, double hi, double origin, double cell, std::size_t n) {
    const auto first = static_cast<std::ptrdiff_t>(std::ceil((lo - origin) / cell - 0.5));
    const auto last = static_cast<std::ptrdiff_t>(std::ceil((hi - origin) / cell - 0.5)) - 1;
    return {std::max<std::ptrdiff_t>(first, 0), std::min(last, static_cast<std::ptrdiff_t>(n) - 1)};
}

// The mean of what the raster says over a rectangle.
double mean_over(const Raster& raster, const MapPoint& centre, double dx, double dz) {
    const Run x = centres_within(centre.x - 0.5 * dx, centre.x + 0.5 * dx, raster.x, raster.cell, raster.columns);
    const Run z = centres_within(centre.z - 0.5 * dz, centre.z + 0.5 * dz, raster.z, raster.cell, raster.rows);
    double sum = 0, count = 0;
    for (std::ptrdiff_t row = z.first; row <= z.last; ++row) {
        for (std::ptrdiff_t column = x.first; column <= x.last; ++column) {
            const double v = raster.at(static_cast<std::size_t>(column), static_cast<std::size_t>(row));
            if (std::isnan(v)) continue;
            sum += v;
            count += 1;
        }
    }
    return count > 0 ? sum / count : nothing;
}

// Interpolates linearly between the four cell centres around a point, without centres that have no value; constant in
// the outer half of the cells at the raster's edge.
double between_centres(const Raster& raster, const MapPoint& p) {
    const double x = (p.x - raster.x) / raster.cell - 0.5, z = (p.z - raster.z) / raster.cell - 0.5;
    const auto columns = static_cast<double>(raster.columns), rows = static_cast<double>(raster.rows);
    constexpr double slack = 1e-6;  // a size in the scene is rounded
    if (x < -0.5 - slack || z < -0.5 - slack || x > columns - 0.5 + slack || z > rows - 0.5 + slack) return nothing;
    const double cx = std::clamp(x, 0.0, columns - 1), cz = std::clamp(z, 0.0, rows - 1);
    const double column = std::min(std::floor(cx), std::max(0.0, columns - 2)),
                 row = std::min(std::floor(cz), std::max(0.0, rows - 2));
    double sum = 0, weight = 0;
    for (int n = 0; n < 4; ++n) {
        const double i = std::min(column + (n & 1), columns - 1), k = std::min(row + (n >> 1), rows - 1);
        const double fx = cx - column, fz = cz - row;
        const double w = ((n & 1) != 0 ? fx : 1 - fx) * ((n >> 1) != 0 ? fz : 1 - fz);
        const double v = raster.at(static_cast<std::size_t>(i), static_cast<std::size_t>(k));
        if (std::isnan(v) || w <= 0) continue;
        sum += w * v;
        weight += w;
    }
    return weight > 0 ? sum / weight : nothing;
}

double of_cell(const Raster& raster, const Grid& grid, const MapPoint& centre) {
    const bool finer = raster.cell < 0.99 * std::min(grid.dx, grid.dz);
    return finer ? mean_over(raster, centre, grid.dx, grid.dz) : between_centres(raster, centre);
}

}  // namespace

RowMemory ground_heights(const Ground& ground, const Grid& grid) {
    RowMemory height(grid.stored(), 0);
    const Triangles surface(ground.raster ? std::vector<std::array<double, 3>>{} : ground.points);
    for_each_centre(grid, [&](std::size_t c, std::size_t, const MapPoint& p) {
        if (ground.raster) {
            height[c] = of_cell(*ground.raster, grid, p);
        } else if (!ground.points.empty()) {
            height[c] = surface.height_at(p);
        } else {
            height[c] = ground.level + ground.slope_x * p.x + ground.slope_z * p.z;
        }
    });
    return height;
}

RowMemory squares_of_manning(const Roughness& roughness, const Grid& grid) {
    RowMemory squares;
    if (!roughness.raster && roughness.zones.empty()) return squares;
    squares.assign(grid.stored(), roughness.n * roughness.n);
    if (roughness.raster) {
        for_each_centre(grid, [&](std::size_t c, std::size_t, const MapPoint& p) {
            const double n = of_cell(*roughness.raster, grid, p);
            if (!std::isnan(n)) squares[c] = n * n;
        });
    }
    for (const ManningZone& zone : roughness.zones) {
        const std::vector<double> covered = cover_of_cells(grid, {&zone.polygon});
        for_each_centre(grid, [&](std::size_t c, std::size_t number, const MapPoint&) {
            squares[c] += covered[number] * (zone.n * zone.n - squares[c]);
        });
    }
    return squares;
}

Bed site_bed(const Site& site, const Grid& grid) {
    Bed bed;
    bed.ground = ground_heights(site.ground, grid);
    bed.n_squared = squares_of_manning(site.roughness, grid);
    bed.height = bed.ground;
    std::replace_if(
        bed.height.begin(), bed.height.end(), [](double b) { return std::isnan(b); }, 0.0);
    return bed;
}

void fill_site(const Site& site, const Grid& grid, const RowMemory& ground, const RowMemory& open, RowMemory& depth) {
    const auto open_share = [&](std::size_t c) { return open.empty() ? 1 : open[c]; };
    for (const StandingWater& water : site.water) {
        std::vector<double> covered;
        if (!water.polygon.rings.empty()) covered = cover_of_cells(grid, {&water.polygon});
        for_each_centre(grid, [&](std::size_t c, std::size_t number, const MapPoint&) {
            if (open_share(c) <= 0) return;
            const double share = covered.empty() ? 1 : std::min(1.0, covered[number] / open_share(c));
            depth[c] = std::max(depth[c], share * std::max(0.0, water.level - ground[c]));
        });
    }
    if (!site.water_depth) return;
    for_each_centre(grid, [&](std::size_t c, std::size_t, const MapPoint& p) {
        const double h = of_cell(*site.water_depth, grid, p);
        if (!std::isnan(h) && open_share(c) > 0) depth[c] = std::max(depth[c], h);
    });
}

}  // namespace wade::fluid::shallow_water
