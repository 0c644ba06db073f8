// Whether a place can be flooded and walked on: ground under all of it, houses that are houses, water that falls on the ground.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "configs/checks/scene_checks.hpp"
#include "configs/scene/choices.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/world.hpp"

namespace wade {

double on_map::turn(const MapPoint& a, const MapPoint& b, const MapPoint& c) {
    return (b.x - a.x) * (c.z - a.z) - (b.z - a.z) * (c.x - a.x);
}

bool on_map::cross(const MapPoint& a, const MapPoint& b, const MapPoint& c, const MapPoint& d) {
    return turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;
}

MapPoint on_map::nearest_on(const MapPoint& a, const MapPoint& b, const MapPoint& p) {
    const double x = b.x - a.x, z = b.z - a.z, square = x * x + z * z;
    const double along = square > 0 ? std::clamp(((p.x - a.x) * x + (p.z - a.z) * z) / square, 0.0, 1.0) : 0;
    return {a.x + along * x, a.z + along * z};
}

namespace {

std::string at_words(double x, double z) {
    return "x " + short_number(x) + " m, z " + short_number(z) + " m";
}

// All digits that a tool needs to find the same value.
std::string exact_number(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", value);
    return text;
}

// A label begins with the key and may go on with file and feature.
[[noreturn]] void refuse_shape(const std::string& source, const std::string& label, const std::string& sentence) {
    throw ConfigurationError(source + ": " + label + ": " + sentence);
}

struct MapBox {
    Interval x{INFINITY, -INFINITY}, z{INFINITY, -INFINITY};

    void take(const MapPoint& p) {
        x = {std::min(x.lo, p.x), std::max(x.hi, p.x)};
        z = {std::min(z.lo, p.z), std::max(z.hi, p.z)};
    }
    [[nodiscard]] bool meets(const MapBox& other) const {
        return x.lo <= other.x.hi && other.x.lo <= x.hi && z.lo <= other.z.hi && other.z.lo <= z.hi;
    }
};

MapBox box_of(const MapPolygon& polygon, const MapLine& line = {}) {
    MapBox box;
    for (const MapPoint& p : line) box.take(p);
    for (const MapLine& ring : polygon.rings) {
        for (const MapPoint& p : ring) box.take(p);
    }
    return box;
}

// Where a ring crosses itself: its edges by their smallest x, each against those that begin before it ends.
std::optional<MapPoint> crossing_of(const MapLine& ring) {
    struct Edge {
        MapPoint a, b;
        [[nodiscard]] double lo() const { return std::min(a.x, b.x); }
        [[nodiscard]] double hi() const { return std::max(a.x, b.x); }
    };
    std::vector<Edge> edges;
    for (std::size_t k = 0; k < ring.size(); ++k) edges.push_back({ring[k], ring[(k + 1) % ring.size()]});
    std::sort(edges.begin(), edges.end(), [](const Edge& one, const Edge& other) { return one.lo() < other.lo(); });
    for (std::size_t i = 0; i < edges.size(); ++i) {
        for (std::size_t k = i + 1; k < edges.size() && edges[k].lo() <= edges[i].hi(); ++k) {
            const auto& [a, b] = edges[i];
            const auto& [c, d] = edges[k];
            if (!on_map::cross(a, b, c, d)) continue;
            const double along = on_map::turn(c, d, a) / (on_map::turn(c, d, a) - on_map::turn(c, d, b));
            return MapPoint{a.x + along * (b.x - a.x), a.z + along * (b.z - a.z)};
        }
    }
    return std::nullopt;
}

double area_of(const MapLine& ring) {
    double twice = 0;
    for (std::size_t k = 1; k + 1 < ring.size(); ++k) twice += on_map::turn(ring[0], ring[k], ring[k + 1]);
    return std::abs(twice) / 2;
}

double distance_to(const MapLine& ring, const MapPoint& p) {
    double nearest = INFINITY;
    for (std::size_t k = 0; k < ring.size(); ++k) {
        const MapPoint foot = on_map::nearest_on(ring[k], ring[(k + 1) % ring.size()], p);
        nearest = std::min(nearest, std::hypot(p.x - foot.x, p.z - foot.z));
    }
    return nearest;
}

// Which house, if any, a point lies in: houses by the square of a lattice over the world.
class HouseFinder {
 public:
    explicit HouseFinder(const Scene& scene) : houses_(scene.place->houses), world_(scene.world), lists_(side * side) {
        for (std::size_t h = 0; h < houses_.size(); ++h) {
            const MapBox box = box_of(houses_[h].polygon);
            for (std::size_t k = column(box.x.lo); k <= column(box.x.hi); ++k) {
                for (std::size_t r = row(box.z.lo); r <= row(box.z.hi); ++r) lists_[r * side + k].push_back(h);
            }
        }
    }

    [[nodiscard]] const House* at(const MapPoint& p) const {
        for (const std::size_t h : lists_[row(p.z) * side + column(p.x)]) {
            if (contains(houses_[h].polygon, p)) return &houses_[h];
        }
        return nullptr;
    }

 private:
    static constexpr std::size_t side = 64;

    static std::size_t index(double share) {
        return static_cast<std::size_t>(
            std::clamp(share * static_cast<double>(side), 0.0, static_cast<double>(side - 1)));
    }
    [[nodiscard]] std::size_t column(double x) const { return index(x / world_.length); }
    [[nodiscard]] std::size_t row(double z) const { return index(z / world_.width); }

    const std::vector<House>& houses_;
    const World& world_;
    std::vector<std::vector<std::size_t>> lists_;
};

void check_model(const Scene& scene, const std::string& source) {
    const ModelKind model = scene.fluid->model;
    if (model != ModelKind::shallow_water && model != ModelKind::dfsph) {
        refuse(source, "/fluid/model",
               quoted(model) +
                   " knows no ground but a channel's bed; allowed beside /place: \"shallow_water\", \"dfsph\".");
    }
    if (scene.world->ends != Ends::open)
        refuse(source, "/world/ends", "\"periodic\" beside /place; allowed: \"open\".");
}

// A cell of a raster in the world is a cell that has its centre there.
bool is_in_world(const MapPoint& p, const World& world) {
    return 0 <= p.x && p.x <= world.length && 0 <= p.z && p.z <= world.width;
}

void check_extent(const Scene& scene, const Raster& raster, const std::string& source) {
    const double slack = rounding_tolerance * (scene.world->length + scene.world->width) + 1e-6 * raster.cell;
    const Interval x{raster.x, raster.x + static_cast<double>(raster.columns) * raster.cell};
    const Interval z{raster.z, raster.z + static_cast<double>(raster.rows) * raster.cell};
    if (x.lo <= slack && z.lo <= slack && x.hi >= scene.world->length - slack && z.hi >= scene.world->width - slack)
        return;
    refuse(
        source, "/place/ground/file",
        scene.place->ground.file + ": it covers x " + short_number(x.lo) + " to " + short_number(x.hi) + " m, z " +
            short_number(z.lo) + " to " + short_number(z.hi) + " m of a world of " + short_number(scene.world->length) +
            " x " + short_number(scene.world->width) +
            " m. Remedy: leave out /world/length_m, /world/width_m and the place's origin, which then are those of the "
            "raster, or choose them within it.");
}

void check_heights(const Scene& scene, const Raster& raster, const std::string& source) {
    constexpr double lowest = -500, highest = 9000;  // the Dead Sea's shore, Mount Everest
    for (std::size_t k = 0; k < raster.values.size(); ++k) {
        const double value = raster.values[k];
        if (std::isnan(value) || (value >= lowest && value <= highest)) continue;
        refuse(source, "/place/ground/file",
               scene.place->ground.file + ": the height of row " + std::to_string(raster.rows - k / raster.columns) +
                   " from the top, column " + std::to_string(k % raster.columns + 1) + " is " + short_number(value) +
                   " m; allowed: -500 to 9000 m. Remedy: if it stands for \"no data\", gdal_translate -a_nodata " +
                   exact_number(value) + " " + scene.place->ground.file + " OUT.tif.");
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
        if (!is_in_world(centre, scene.world)) continue;
        if (!std::isnan(raster.values[k])) ++valid;
        if (!std::isnan(raster.values[k]) || outside[k]) continue;
        if (holes++ == 0) first = centre;
    }
    const std::string remedy = " Remedy: tools/wade place import --fill fills holes from their edges.";
    if (valid == 0)
        refuse(source, "/place/ground/file",
               scene.place->ground.file + ": no cell of the world has a height." + remedy);
    if (holes == 0) return;
    refuse(source, "/place/ground/file",
           scene.place->ground.file + ": " + std::to_string(holes) +
               " cells inside have no height (no data), the first at " + at_words(first.x, first.z) + "." + remedy);
}

void check_water_depth(const Scene& scene, const std::string& source) {
    const Place& place = *scene.place;
    if (!place.water_depth) return;
    constexpr double deepest = 1000;  // m, as of a level above the ground
    for (const double depth : place.water_depth->values) {
        if (std::isnan(depth) || (depth >= 0 && depth <= deepest)) continue;
        refuse(source, "/place/water_depth_file",
               place.water_file + ": a depth of " + short_number(depth) +
                   " m; allowed: 0 to 1000 m. Remedy: gdal_translate -a_nodata " + exact_number(depth) + " " +
                   place.water_file + " OUT.tif, if it stands for \"no data\".");
    }
}

void check_rings(const MapPolygon& polygon, const std::string& label, const std::string& source) {
    constexpr double least_area = 0.01;  // m2
    for (const MapLine& ring : polygon.rings) {
        if (ring.size() < 3)
            refuse_shape(source, label,
                         std::to_string(ring.size()) + " corners; allowed: at least 3. Remedy: take it out.");
        if (const auto place = crossing_of(ring)) {
            refuse_shape(source, label,
                         "its outline crosses itself at " + at_words(place->x, place->z) +
                             ". Remedy: draw its corners in order, or ogr2ogr -makevalid.");
        }
        if (area_of(ring) < least_area)
            refuse_shape(source, label,
                         "its corners enclose " + short_number(area_of(ring)) + " m2; allowed: >= " +
                             short_number(least_area) + " m2. Remedy: take it out, or draw its corners in order.");
    }
}

void check_in_world(const MapBox& box, const Scene& scene, const std::string& label, const std::string& source) {
    if (box.meets({{0, scene.world->length}, {0, scene.world->width}})) return;
    refuse_shape(
        source, label,
        "it lies outside the place, at " + at_words(box.x.lo, box.z.lo) + "; allowed: x 0 to " +
            short_number(scene.world->length) + " m, z 0 to " + short_number(scene.world->width) +
            " m. Remedy: tools/wade place import crops files to the ground; or is its coordinate system another one?");
}

void check_house(const House& house, const Scene& scene, const std::string& source) {
    check_rings(house.polygon, house.label, source);
    check_in_world(box_of(house.polygon), scene, house.label, source);
    constexpr double at_most = 1;  // [A] a door drawn by hand is off its wall by less
    for (const MapPoint& door : house.doors) {
        double nearest = INFINITY;
        for (const MapLine& ring : house.polygon.rings) nearest = std::min(nearest, distance_to(ring, door));
        if (nearest <= at_most) continue;
        refuse_shape(source, house.label,
                     "its door at " + at_words(door.x, door.z) + " is " + short_number(nearest) +
                         " m away from its walls; allowed: <= " + short_number(at_most) + " m.");
    }
}

// Some of the points over which a source spreads its water, about as far apart as the cells.
std::vector<MapPoint> points_of(const Source& source, double cell) {
    constexpr double most = 200;  // in a row
    std::vector<MapPoint> points = source.line;
    const MapBox box = box_of(source.polygon, source.line);
    for (std::size_t k = 1; k < source.line.size(); ++k) {
        const MapPoint &a = source.line[k - 1], &b = source.line[k];
        const double length = std::hypot(b.x - a.x, b.z - a.z), steps = std::clamp(std::ceil(length / cell), 1.0, most);
        for (double s = 1; s < steps; ++s)
            points.push_back({a.x + s / steps * (b.x - a.x), a.z + s / steps * (b.z - a.z)});
    }
    if (!source.polygon.rings.empty()) {
        const double dx = std::max(cell, box.x.length() / most), dz = std::max(cell, box.z.length() / most);
        for (double x = box.x.lo + dx / 2; x < box.x.hi; x += dx) {
            for (double z = box.z.lo + dz / 2; z < box.z.hi; z += dz) {
                if (contains(source.polygon, {x, z})) points.push_back({x, z});
            }
        }
        if (points.empty()) points.push_back({(box.x.lo + box.x.hi) / 2, (box.z.lo + box.z.hi) / 2});
    }
    return points;
}

// Whether there is ground under a point: a cell with a height.
bool has_ground(const Ground& ground, const MapPoint& p) {
    if (!ground.raster) return true;
    const Raster& raster = *ground.raster;
    const double last_column = static_cast<double>(raster.columns - 1), last_row = static_cast<double>(raster.rows - 1);
    const auto column = static_cast<std::size_t>(std::clamp((p.x - raster.x) / raster.cell, 0.0, last_column));
    const auto row = static_cast<std::size_t>(std::clamp((p.z - raster.z) / raster.cell, 0.0, last_row));
    return !std::isnan(raster.at(column, row));
}

void check_source(const Source& made, const Scene& scene, const HouseFinder& houses, const std::string& source) {
    if (made.line.empty()) check_rings(made.polygon, made.label, source);
    check_in_world(box_of(made.polygon, made.line), scene, made.label, source);
    const House* roof = nullptr;
    for (const MapPoint& p : points_of(made, scene.fluid->shallow_water.cell_size)) {
        if (!is_in_world(p, scene.world) || !has_ground(scene.place->ground, p)) continue;
        const House* const house = houses.at(p);
        if (!house) return;
        roof = house;
    }
    if (!roof) refuse_shape(source, made.label, "there is no ground under it (no data). Remedy: move it.");
    refuse_shape(source, made.label,
                 "all of it lies on a roof, that of " + roof->label + ". Remedy: move it to the ground beside.");
}

void check_gauge(const Gauge& gauge, const Scene& scene, const HouseFinder& houses, const std::string& source) {
    check_in_world(box_of({}, {gauge.at}), scene, gauge.label, source);
    const House* const house = houses.at(gauge.at);
    if (!house && has_ground(scene.place->ground, gauge.at)) return;
    const std::string where = house ? "in the house " + house->label : "where the ground has no height";
    refuse_shape(source, gauge.label,
                 gauge.name + " at " + at_words(gauge.at.x, gauge.at.z) + " is " + where + ". Remedy: move it.");
}

// The first agent of each group that starts in a wall or where there is no ground.
void check_starts_on_place(const Scene& scene, const HouseFinder& houses, const std::string& source,
                           Problems& problems) {
    std::vector<bool> told(scene.crowd->groups.size());
    const std::vector<StartPlace> starts = start_places(scene.crowd);
    for (std::size_t i = 0; i < starts.size(); ++i) {
        const MapPoint p{starts[i].x, starts[i].z};
        if (told[starts[i].group] || !is_in_world(p, scene.world)) continue;
        const House* const house = houses.at(p);
        if (!house && has_ground(scene.place->ground, p)) continue;
        told[starts[i].group] = true;
        const std::string where = house ? "in the house " + house->label +
                                              ". Remedy: start beside it; who is indoors at t = 0 are its residents."
                                        : "where the ground has no height. Remedy: start on the ground.";
        problems.attempt([&] {
            refuse(source, "/crowd/groups/" + std::to_string(starts[i].group) + "/start",
                   "agent " + std::to_string(i) + " at " + at_words(p.x, p.z) + " starts " + where);
        });
    }
}

}  // namespace

void check_place(const Scene& scene, const std::string& source, Problems& problems) {
    if (!scene.place) return;
    const Place& place = *scene.place;
    problems.attempt([&] { check_model(scene, source); });
    if (place.ground.raster) {
        const Raster& raster = *place.ground.raster;
        problems.attempt([&] {
            check_extent(scene, raster, source);
            check_heights(scene, raster, source);
            check_holes(scene, raster, source);
        });
    }
    problems.attempt([&] { check_water_depth(scene, source); });
    for (const House& house : place.houses) problems.attempt([&] { check_house(house, scene, source); });
    const HouseFinder houses(scene);
    for (const Source& made : place.sources) problems.attempt([&] { check_source(made, scene, houses, source); });
    const auto check_shape = [&](const MapPolygon& polygon, const MapLine& line, const std::string& label) {
        problems.attempt([&] {
            if (line.empty()) check_rings(polygon, label, source);
            check_in_world(box_of(polygon, line), scene, label, source);
        });
    };
    for (const Outlet& outlet : place.outlets) check_shape(outlet.polygon, outlet.line, outlet.label);
    for (const ManningZone& zone : place.roughness.zones) check_shape(zone.polygon, {}, zone.label);
    for (const StandingWater& water : place.water)
        if (!water.polygon.rings.empty()) check_shape(water.polygon, {}, water.label);
    for (const Gate& gate : place.gates) check_shape({}, gate.line, gate.label);
    std::set<std::string> names;
    for (const Gauge& gauge : place.gauges) {
        problems.attempt([&] {
            check_gauge(gauge, scene, houses, source);
            if (!names.insert(gauge.name).second)
                refuse_shape(source, gauge.label, gauge.name + " is the name of another gauge, too. Remedy: name it.");
        });
    }
    for (const PlaceShelter& shelter : place.shelters) check_shape(shelter.polygon, {}, shelter.label);
    check_starts_on_place(scene, houses, source, problems);
}

}  // namespace wade
