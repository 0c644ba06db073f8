#pragma once
// A site: ground of any shape with houses, sources and outlets on it, instead of the straight channel.
//
// Lengths are metres on the map: x runs east, z north, both from the scene's origin, which lies at (origin_x, origin_z) of the
// coordinate system; y is the height above the system's zero. Rasters, polygons and series that a scene names as files are
// here as they were read, in these coordinates.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "configs/numbers/portable.hpp"

namespace wade {

// A point of the map, m.
struct MapPoint {
    double x = 0;
    double z = 0;
};

// Corners of a closed line, the last one joined to the first; or of an open line.
using MapLine = std::vector<MapPoint>;

// Even-odd: a point is inside if a line from it to infinity crosses an odd number of edges of all rings, so that holes are rings.
struct MapPolygon {
    std::vector<MapLine> rings;
};

// Values on square cells, NaN where there is none. Row 0 is the southern one; the value of a cell is that at its centre.
struct Raster {
    double x = 0, z = 0;  // of the lower left corner of the lower left cell, m
    double cell = 1;      // m
    std::size_t columns = 0, rows = 0;
    std::vector<double> values;  // by row, then column

    [[nodiscard]] double at(std::size_t column, std::size_t row) const { return values[row * columns + column]; }
};

// A value in time: straight between its points, constant before the first and after the last.
struct SeriesPoint {
    double time = 0;  // s
    double value = 0;
};
using Series = std::vector<SeriesPoint>;

// Returns the value at a time, s; 0 if there are no points.
[[nodiscard]] inline double value_at(const Series& series, double time) {
    if (series.empty()) return 0;
    if (time <= series.front().time) return series.front().value;
    for (std::size_t n = 1; n < series.size(); ++n) {
        const SeriesPoint &a = series[n - 1], &b = series[n];
        if (time <= b.time) return a.value + (b.value - a.value) * (time - a.time) / (b.time - a.time);
    }
    return series.back().value;
}

// Returns the integral from one time to another, s.
[[nodiscard]] inline double integral_of(const Series& series, double begin, double end) {
    double sum = 0, last = begin, value = value_at(series, begin);
    const auto up_to = [&](double time, double next) {
        sum += 0.5 * (value + next) * (time - last);
        last = time, value = next;
    };
    const auto first = std::upper_bound(series.begin(), series.end(), begin,
                                        [](double time, const SeriesPoint& p) { return time < p.time; });
    for (auto p = first; p != series.end() && p->time < end; ++p) up_to(p->time, p->value);
    up_to(end, value_at(series, end));
    return sum;
}

// The ground: a raster, or the plane level + slope_x x + slope_z z with points on it, between which it is linear.
struct Ground {
    std::string file;                           // of the raster, as the scene names it; empty: none
    std::shared_ptr<const Raster> raster;       // height, m
    double level = 0;                           // m, at the origin
    double slope_x = 0, slope_z = 0;            // rise of the plane along x and along z, m a metre
    std::vector<std::array<double, 3>> points;  // x, y, z of a surface through these, m; instead of the plane
};

// Walls for the water and for people outside; never raised ground.
struct House {
    std::string name;
    MapPolygon polygon;
    double height = 6;            // of the walls above the ground, m
    int residents = 0;            // people in it at t = 0
    std::vector<MapPoint> doors;  // on its walls, m; none: the corner of the ground plan's lowest ground
    double upper_floor =
        std::numeric_limits<double>::quiet_NaN();  // height above the ground of the upper floor, m; NaN: there is none
    std::string label{};                           // where a scene says it, for messages
};

// Manning's n of the ground where no zone says otherwise, s/m^(1/3); of zones that overlap the last one holds.
struct ManningZone {
    MapPolygon polygon;
    double n = 0.03;
    std::string label{};
};
struct Roughness {
    double n = 0.03;
    std::string file;
    std::shared_ptr<const Raster> raster;
    std::vector<ManningZone> zones;
};

// Water that comes in: spread evenly over a polygon, or over the cells along a line.
struct Source {
    std::string name;
    MapPolygon polygon;  // empty: along `line`
    MapLine line;
    Series discharge;     // m3/s
    std::string label{};  // as that of a house
};

enum class OutletKind {
    free,   // water leaves as over a fall
    stage,  // a large water at rest with a given level in time: the surface stands at it, waves come back inverted
    wave    // open water: the level of the incoming wave is given in time, waves from inside leave
};

// Where water leaves: the cells of a polygon, or those that a line crosses; also where it touches the site's edge.
struct Outlet {
    std::string name;
    OutletKind kind = OutletKind::free;
    MapPolygon polygon;  // empty: along `line`
    MapLine line;
    Series stage;  // height of the surface, or of the incoming wave, its first value the level at rest, m
    std::string label{};
};

// A thin wall along a line: a flood wall, or a gate that is gone from a time on.
struct Barrier {
    std::string name;
    MapLine line;
    double crest = std::numeric_limits<double>::infinity();     // level of its top, m; infinite: no water runs over it
    double opens_at = std::numeric_limits<double>::infinity();  // s; infinite: it stays
    MapPolygon plan{};                                          // of a flood wall, for people
    std::string label{};
};

// Water at t = 0 that stands at a level; without polygon everywhere.
struct StandingWater {
    MapPolygon polygon;
    double level = 0;  // height of the surface, m
    std::string label{};
};

// Where the water is written in time.
struct Gauge {
    std::string name;
    MapPoint at;
    std::string label{};
};

// Where people are safe.
struct SiteShelter {
    std::string name;
    MapPolygon polygon;
    int capacity = 0;  // people; 0: any number
    std::string label{};
    bool is_exit = false;  // people that get there have left the site
};

struct Resident;  // a person of a table (fields/people.hpp)

struct Site {
    int epsg = 0;                       // of the coordinate system; 0: none is given
    double origin_x = 0, origin_z = 0;  // of the scene's origin in it, easting and northing, m
    Ground ground;
    std::vector<House> houses;
    Roughness roughness;
    std::vector<Source> sources;
    Series rain;  // mm/h, on every cell that is no house; empty: none
    std::vector<Outlet> outlets;
    std::vector<Barrier> barriers;
    std::vector<StandingWater> water;  // at t = 0
    std::string water_file;            // raster of depths at t = 0, m
    std::shared_ptr<const Raster> water_depth;
    std::vector<Gauge> gauges;
    std::vector<SiteShelter> shelters;
    std::shared_ptr<const std::vector<Resident>> residents;  // of the table; none: there is none
};

// Whether a point lies in a polygon; on an edge it may be either.
[[nodiscard]] inline bool contains(const MapPolygon& polygon, const MapPoint& p) {
    bool inside = false;
    for (const MapLine& ring : polygon.rings) {
        for (std::size_t k = 0, last = ring.size() - 1; k < ring.size(); last = k++) {
            const MapPoint &a = ring[last], &b = ring[k];
            if ((a.z > p.z) == (b.z > p.z)) continue;
            if (p.x < a.x + (b.x - a.x) * (p.z - a.z) / (b.z - a.z)) inside = !inside;
        }
    }
    return inside;
}

// Whether a point lies in an outlet, or no further than `reach`, m, from its line.
[[nodiscard]] inline bool is_at(const Outlet& outlet, const MapPoint& p, double reach) {
    if (contains(outlet.polygon, p)) return true;
    for (std::size_t k = 1; k < outlet.line.size(); ++k) {
        const MapPoint &a = outlet.line[k - 1], &b = outlet.line[k];
        const double x = b.x - a.x, z = b.z - a.z, square = x * x + z * z;
        const double along = square > 0 ? std::clamp(((p.x - a.x) * x + (p.z - a.z) * z) / square, 0.0, 1.0) : 0;
        if (length_of(a.x + along * x - p.x, a.z + along * z - p.z) <= reach) return true;
    }
    return false;
}

// Returns a raster's value: bilinear between the centres of cells that have a value, constant beyond the outer centres;
// 0 if none of the nearest four cells has a value.
[[nodiscard]] inline double height_in(const Raster& raster, const MapPoint& p) {
    const auto columns = static_cast<double>(raster.columns), rows = static_cast<double>(raster.rows);
    const double x = std::clamp((p.x - raster.x) / raster.cell - 0.5, 0.0, columns - 1);
    const double z = std::clamp((p.z - raster.z) / raster.cell - 0.5, 0.0, rows - 1);
    const double column = std::min(std::floor(x), std::max(0.0, columns - 2));
    const double row = std::min(std::floor(z), std::max(0.0, rows - 2));
    double sum = 0, weights = 0;
    for (const int up : {0, 1}) {
        for (const int right : {0, 1}) {
            const double i = std::min(column + right, columns - 1), k = std::min(row + up, rows - 1);
            const double weight = std::max(0.0, 1 - std::abs(x - i)) * std::max(0.0, 1 - std::abs(z - k));
            const double value = raster.at(static_cast<std::size_t>(i), static_cast<std::size_t>(k));
            if (std::isnan(value) || !(weight > 0)) continue;
            sum += weight * value;
            weights += weight;
        }
    }
    return weights > 0 ? sum / weights : 0;
}

// Returns the height of the ground, m. Points are weighted by the inverse squares of their distances, without a
// triangulation [A].
[[nodiscard]] inline double ground_height(const Ground& ground, const MapPoint& p) {
    if (ground.raster) return height_in(*ground.raster, p);
    if (ground.points.empty()) return ground.level + ground.slope_x * p.x + ground.slope_z * p.z;
    double sum = 0, weights = 0;
    for (const auto& [x, y, z] : ground.points) {
        const double square = (p.x - x) * (p.x - x) + (p.z - z) * (p.z - z);
        if (!(square > 1e-12)) return y;
        sum += y / square;
        weights += 1 / square;
    }
    return sum / weights;
}

}  // namespace wade
