// Whether the rasters of a site hold heights and depths of ground that can be flooded.

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "configs/checks/scene_checks.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/world.hpp"

namespace wade {

namespace {

// All digits that a tool needs to find the same value.
std::string exact_number(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", value);
    return text;
}

// A cell of a raster in the world is a cell that has its centre there.
bool is_centre_in_world(const MapPoint& p, const World& world) {
    return 0 <= p.x && p.x <= world.length && 0 <= p.z && p.z <= world.width;
}

void check_extent(const Scene& scene, const Raster& raster, const std::string& source) {
    const double slack = rounding_tolerance * (scene.world->length + scene.world->width) + 1e-6 * raster.cell;
    const Interval x{raster.x, raster.x + static_cast<double>(raster.columns) * raster.cell};
    const Interval z{raster.z, raster.z + static_cast<double>(raster.rows) * raster.cell};
    if (x.lo <= slack && z.lo <= slack && x.hi >= scene.world->length - slack && z.hi >= scene.world->width - slack)
        return;
    refuse(
        source, "/site/ground/file",
        scene.site->ground.file + ": it covers x " + short_number(x.lo) + " to " + short_number(x.hi) + " m, z " +
            short_number(z.lo) + " to " + short_number(z.hi) + " m of a world of " + short_number(scene.world->length) +
            " x " + short_number(scene.world->width) +
            " m. Remedy: leave out /world/length_m, /world/width_m and the site's origin, which then are those of the "
            "raster, or choose them within it.");
}

void check_heights(const Scene& scene, const Raster& raster, const std::string& source) {
    constexpr double lowest = -500, highest = 9000;  // the Dead Sea's shore, Mount Everest
    for (std::size_t k = 0; k < raster.values.size(); ++k) {
        const double value = raster.values[k];
        if (std::isnan(value) || (value >= lowest && value <= highest)) continue;
        refuse(source, "/site/ground/file",
               scene.site->ground.file + ": the height of row " + std::to_string(raster.rows - k / raster.columns) +
                   " from the top, column " + std::to_string(k % raster.columns + 1) + " is " + short_number(value) +
                   " m; allowed: -500 to 9000 m. Remedy: if it stands for \"no data\", gdal_translate -a_nodata " +
                   exact_number(value) + " " + scene.site->ground.file + " OUT.tif.");
    }
}

// Marks the cells without a height that are joined over such cells to the raster's edge: those are the outside. Runs of a row are taken
// at once, so that few wait.
std::vector<bool> outside_of(const Raster& raster) {
    const std::size_t columns = raster.columns, rows = raster.rows;
    std::vector<bool> outside(raster.values.size());
    std::vector<std::size_t> open;  // one cell of each run that was reached
    const auto is_free = [&](std::size_t k) { return !outside[k] && std::isnan(raster.values[k]); };
    const auto spread = [&](std::size_t start) {
        if (is_free(start)) open.push_back(start);
        while (!open.empty()) {
            const std::size_t k = open.back(), row = k / columns * columns;
            open.pop_back();
            if (!is_free(k)) continue;
            std::size_t lo = k, hi = k;
            while (lo > row && is_free(lo - 1)) --lo;
            while (hi + 1 < row + columns && is_free(hi + 1)) ++hi;
            for (std::size_t n = lo; n <= hi; ++n) outside[n] = true;
            const auto look = [&](std::size_t first, std::size_t last) {
                for (std::size_t n = first; n <= last; ++n) {
                    if (is_free(n) && (n == first || !is_free(n - 1))) open.push_back(n);
                }
            };
            if (row > 0) look(lo - columns, hi - columns);
            if (row / columns + 1 < rows) look(lo + columns, hi + columns);
        }
    };
    for (std::size_t c = 0; c < columns; ++c) {
        spread(c);
        spread((rows - 1) * columns + c);
    }
    for (std::size_t r = 0; r < rows; ++r) {
        spread(r * columns);
        spread(r * columns + columns - 1);
    }
    return outside;
}

// Cells without a height inside of the ground are refused.
void check_holes(const Scene& scene, const Raster& raster, const std::string& source) {
    const std::vector<bool> outside = outside_of(raster);
    const std::size_t columns = raster.columns;
    std::size_t holes = 0, valid = 0;
    MapPoint first;
    for (std::size_t k = 0; k < raster.values.size(); ++k) {
        const std::size_t c = k % columns, r = k / columns;
        const MapPoint centre{raster.x + (static_cast<double>(c) + 0.5) * raster.cell,
                              raster.z + (static_cast<double>(r) + 0.5) * raster.cell};
        if (!is_centre_in_world(centre, scene.world)) continue;
        if (!std::isnan(raster.values[k])) ++valid;
        if (!std::isnan(raster.values[k]) || outside[k]) continue;
        if (holes++ == 0) first = centre;
    }
    const std::string remedy = " Remedy: tools/wade site import --fill fills holes from their edges.";
    if (valid == 0)
        refuse(source, "/site/ground/file", scene.site->ground.file + ": no cell of the world has a height." + remedy);
    if (holes == 0) return;
    refuse(source, "/site/ground/file",
           scene.site->ground.file + ": " + std::to_string(holes) +
               " cells inside have no height (no data), the first at " + "x " + short_number(first.x) + " m, z " +
               short_number(first.z) + " m" + "." + remedy);
}

void check_water_depth(const Scene& scene, const std::string& source) {
    const Site& site = *scene.site;
    if (!site.water_depth) return;
    constexpr double deepest = 1000;  // m, as of a level above the ground
    for (const double depth : site.water_depth->values) {
        if (std::isnan(depth) || (depth >= 0 && depth <= deepest)) continue;
        refuse(source, "/site/water_depth_file",
               site.water_file + ": a depth of " + short_number(depth) +
                   " m; allowed: 0 to 1000 m. Remedy: gdal_translate -a_nodata " + exact_number(depth) + " " +
                   site.water_file + " OUT.tif, if it stands for \"no data\".");
    }
}

}  // namespace

void check_ground(const Scene& scene, const std::string& source, Problems& problems) {
    const Site& site = *scene.site;
    if (site.ground.raster) {
        const Raster& raster = *site.ground.raster;
        problems.attempt([&] {
            check_extent(scene, raster, source);
            check_heights(scene, raster, source);
            check_holes(scene, raster, source);
        });
    }
    problems.attempt([&] { check_water_depth(scene, source); });
}

}  // namespace wade
