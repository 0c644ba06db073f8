// Whether a site can be flooded and walked on: ground under all of it, houses that are houses, water that falls on the ground.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include "configs/checks/scene_checks.hpp"
#include "configs/numbers/portable.hpp"
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

MapBox box_of(const MapPolygon& polygon) {
    MapBox box;
    for (const MapLine& ring : polygon.rings) {
        for (const MapPoint& p : ring) box.take(p);
    }
    return box;
}

// Counts the comparisons of corners with doors, so that the checks of a scene do not take long.
class Work {
 public:
    void take(std::size_t steps, const std::string& source, const std::string& label) {
        if (steps > left_)
            refuse_shape(source, label,
                         "the houses have too many corners and doors to be checked. Remedy: ogr2ogr -simplify 0.1, or "
                         "leave out what lies beside the site.");
        left_ -= steps;
    }

 private:
    std::size_t left_ = 200'000'000;
};

double area_of(const MapLine& ring) {
    double twice = 0;
    for (std::size_t k = 1; k + 1 < ring.size(); ++k) twice += on_map::turn(ring[0], ring[k], ring[k + 1]);
    return std::abs(twice) / 2;
}

double distance_to(const MapLine& ring, const MapPoint& p) {
    double nearest = INFINITY;
    for (std::size_t k = 0; k < ring.size(); ++k) {
        const MapPoint foot = on_map::nearest_on(ring[k], ring[(k + 1) % ring.size()], p);
        nearest = std::min(nearest, length_of(p.x - foot.x, p.z - foot.z));
    }
    return nearest;
}

// A house that stands twice counts its people twice; houses that cover the site several times over are no houses.
void check_houses_beside(const Scene& scene, const std::string& source) {
    constexpr double step = 0.1;  // m; corners of the same box differ by less
    const double site = scene.world->length * scene.world->width, most = 4 * site + 1e4;
    std::map<std::array<std::int64_t, 5>, const House*> known;
    double covered = 0;
    for (const House& house : scene.site->houses) {
        const MapBox box = box_of(house.polygon);
        double area = 0;
        for (const MapLine& ring : house.polygon.rings) area += area_of(ring);
        const auto rounded = [](double v) { return static_cast<std::int64_t>(std::llround(v / step)); };
        const auto [other, is_new] = known.insert(
            {{rounded(box.x.lo), rounded(box.x.hi), rounded(box.z.lo), rounded(box.z.hi), rounded(area)}, &house});
        if (!is_new)
            refuse_shape(source, house.label,
                         "it is the same house as " + other->second->label +
                             "; its people would count twice; allowed: once. Remedy: take one out; tools/wade site "
                             "import does.");
        covered += box.x.length() * box.z.length();
        if (covered > most)
            refuse_shape(source, house.label,
                         "the rectangles round the houses up to this one cover " + short_number(covered) +
                             " m2 of a site of " + short_number(site) + " m2; allowed: <= " + short_number(most) +
                             " m2.");
    }
}

// Which house, if any, a point lies in: houses by the square of a lattice over the world.
class HouseFinder {
 public:
    explicit HouseFinder(const Scene& scene) : houses_(scene.site->houses), world_(scene.world), lists_(side * side) {
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
                   " knows no ground but a channel's bed; allowed beside /site: \"shallow_water\", \"dfsph\".");
    }
    if (scene.world->ends != Ends::open) refuse(source, "/world/ends", "\"periodic\" beside /site; allowed: \"open\".");
}

// A cell of a raster in the world is a cell that has its centre there.
bool is_in_world(const MapPoint& p, const World& world) {
    return 0 <= p.x && p.x <= world.length && 0 <= p.z && p.z <= world.width;
}

void check_rings(const MapPolygon& polygon, const std::string& label, const std::string& source) {
    constexpr double least_area = 0.01;  // m2
    for (const MapLine& ring : polygon.rings) {
        if (ring.size() < 3)
            refuse_shape(source, label,
                         std::to_string(ring.size()) + " corners; allowed: at least 3. Remedy: take it out.");
        if (area_of(ring) < least_area)
            refuse_shape(source, label,
                         "its corners enclose " + short_number(area_of(ring)) +
                             " m2; allowed: >= " + short_number(least_area) + " m2. Remedy: take it out.");
    }
}

// How far corners may lie beyond the edge of the world, m [A]: of what stands on the site, and of the outline of a lake or of a kind of
// ground, which the site only cuts.
struct Limits {
    double reach;
    std::size_t corners;  // of one shape [A]: no building or gate is drawn with more, and so many cost less than 0.2 s
};
constexpr Limits works{1000, 10'000}, areas{1e5, 100'000};

// Whether a shape lies in the world, at least a part of it, has no corner far off and not too many: before any work is done on it.
void check_in_world(const MapPolygon& polygon, const MapLine& line, const Limits& limits, const Scene& scene,
                    const std::string& label, const std::string& source) {
    const double length = scene.world->length, width = scene.world->width, reach = limits.reach;
    std::size_t count = line.size();
    for (const MapLine& ring : polygon.rings) count += ring.size();
    if (count > limits.corners)
        refuse_shape(source, label,
                     "it has " + std::to_string(count) + " corners; allowed: <= " + std::to_string(limits.corners) +
                         ". Remedy: ogr2ogr -simplify 0.1.");
    const auto check_corners = [&](const MapLine& corners) {
        for (const MapPoint& p : corners) {
            const double off = std::max({-p.x, p.x - length, -p.z, p.z - width});
            if (off <= reach) continue;
            refuse_shape(source, label,
                         "its corner at " + at_words(p.x, p.z) + " is " + short_number(off) +
                             " m away from the site; allowed: <= " + short_number(reach) +
                             " m. Remedy: move it, or is its coordinate system another one?");
        }
    };
    MapBox box = box_of(polygon);
    for (const MapPoint& p : line) box.take(p);
    if (!box.meets({{0, length}, {0, width}}))
        refuse_shape(source, label,
                     "it lies outside the site, at " + at_words(box.x.lo, box.z.lo) + "; allowed: x 0 to " +
                         short_number(length) + " m, z 0 to " + short_number(width) +
                         " m. Remedy: tools/wade site import crops files to the ground; or is its coordinate system "
                         "another one?");
    check_corners(line);
    for (const MapLine& ring : polygon.rings) check_corners(ring);
}

void check_house(const House& house, const Scene& scene, const std::string& source, Work& work) {
    check_in_world(house.polygon, {}, works, scene, house.label, source);
    check_rings(house.polygon, house.label, source);
    std::size_t corners = 0;
    for (const MapLine& ring : house.polygon.rings) corners += ring.size();
    work.take(corners * house.doors.size(), source, house.label);
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
    std::size_t corners = 1;
    for (const MapLine& ring : source.polygon.rings) corners += ring.size();
    constexpr double points_at_most = 40'000, edges_at_most = 2e7;
    // In a row of a polygon, and of a side of a line.
    const double most = std::max(
        1.0, source.line.empty() ? std::sqrt(std::min(points_at_most, edges_at_most / static_cast<double>(corners)))
                                 : std::min(200.0, points_at_most / static_cast<double>(source.line.size())));
    std::vector<MapPoint> points = source.line;
    const MapBox box = box_of(source.polygon);
    for (std::size_t k = 1; k < source.line.size(); ++k) {
        const MapPoint &a = source.line[k - 1], &b = source.line[k];
        const double length = length_of(b.x - a.x, b.z - a.z), steps = std::clamp(std::ceil(length / cell), 1.0, most);
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
    check_in_world(made.polygon, made.line, works, scene, made.label, source);
    if (made.line.empty()) check_rings(made.polygon, made.label, source);
    const House* roof = nullptr;
    for (const MapPoint& p : points_of(made, scene.fluid->shallow_water.cell_size)) {
        if (!is_in_world(p, scene.world) || !has_ground(scene.site->ground, p)) continue;
        const House* const house = houses.at(p);
        if (!house) return;
        roof = house;
    }
    if (!roof) refuse_shape(source, made.label, "there is no ground under it (no data). Remedy: move it.");
    refuse_shape(source, made.label,
                 "all of it lies on a roof, that of " + roof->label + ". Remedy: move it to the ground beside.");
}

void check_gauge(const Gauge& gauge, const Scene& scene, const HouseFinder& houses, const std::string& source) {
    check_in_world({}, {gauge.at}, works, scene, gauge.label, source);
    const House* const house = houses.at(gauge.at);
    if (!house && has_ground(scene.site->ground, gauge.at)) return;
    const std::string where = house ? "in the house " + house->label : "where the ground has no height";
    refuse_shape(source, gauge.label,
                 gauge.name + " at " + at_words(gauge.at.x, gauge.at.z) + " is " + where + ". Remedy: move it.");
}

// Refuses too many people of the table on one square metre outdoors, in one house, and outdoors beyond the densest packing of
// their bodies in the world.
void check_crowding(const Scene& scene, const HouseFinder& houses, const std::string& source) {
    if (!scene.site->residents) return;
    constexpr int most_outdoors = 10, most_indoors = 100'000;  // on a square metre; as /site/houses/*/residents
    const std::vector<Resident>& residents = *scene.site->residents;
    std::unordered_map<std::uint64_t, int> outdoors;  // by square metre
    outdoors.reserve(residents.size());
    std::unordered_map<const House*, int> indoors;
    std::size_t all_outdoors = 0;
    for (const Resident& one : residents) {
        const House* const house = houses.at({one.x, one.z});
        const auto square = [](double v) {
            return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(std::clamp(v, -1e9, 1e9))));
        };
        const int count = house ? ++indoors[house] : ++outdoors[std::uint64_t{square(one.x)} << 32 | square(one.z)];
        if (!house) ++all_outdoors;
        if (count <= (house ? most_indoors : most_outdoors)) continue;
        refuse(source, "/site/residents_csv",
               "line " + std::to_string(one.line) + ": " + std::to_string(count) + " people stand " +
                   (house ? "in the house " + house->label
                          : "on one square metre outdoors, at " + at_words(one.x, one.z)) +
                   "; allowed: " + std::to_string(house ? most_indoors : most_outdoors) + ".");
    }
    const double radius = scene.crowd->body_radius, length = scene.world->length + 2 * radius,
                 width = scene.world->width + 2 * radius;
    const double most = length * width / (2 * std::sqrt(3.0) * radius * radius);  // the densest packing of discs
    if (scene.crowd->bodies == BodyRule::none || static_cast<double>(all_outdoors) <= most) return;
    refuse(source, "/site/residents_csv",
           std::to_string(all_outdoors) + " people are outdoors; allowed: <= " + std::to_string(std::llround(most)) +
               ", as bodies of radius " + short_number(radius) + " m (/crowd/body_radius_m) fill the world.");
}

// Refuses a flood wall that stands nowhere above the ground.
void check_crest(const Barrier& wall, const Ground& ground, const std::string& source) {
    double lowest = std::numeric_limits<double>::infinity();
    for (const MapPoint& p : wall.line) {
        if (has_ground(ground, p)) lowest = std::min(lowest, ground_height(ground, p));
    }
    if (wall.crest > lowest) return;
    refuse_shape(source, wall.label,
                 "crest_m " + short_number(wall.crest) + " is below the ground at all of its points, at " +
                     short_number(lowest) + " m and more; allowed: above it somewhere.");
}

// The first agent of each group that starts in a wall or where there is no ground.
void check_starts_on_site(const Scene& scene, const HouseFinder& houses, const std::string& source,
                          Problems& problems) {
    std::vector<bool> told(scene.crowd->groups.size());
    const std::vector<StartPlace> starts = start_places(scene.crowd);
    for (std::size_t i = 0; i < starts.size(); ++i) {
        const MapPoint p{starts[i].x, starts[i].z};
        if (told[starts[i].group] || !is_in_world(p, scene.world)) continue;
        const House* const house = houses.at(p);
        if (!house && has_ground(scene.site->ground, p)) continue;
        told[starts[i].group] = true;
        const std::string where = house ? "in the house " + house->label +
                                              ". Remedy: start beside it; people indoors at t = 0 are its residents."
                                        : "where the ground has no height. Remedy: start on the ground.";
        problems.attempt([&] {
            refuse(source, "/crowd/groups/" + std::to_string(starts[i].group) + "/start",
                   "agent " + std::to_string(i) + " at " + at_words(p.x, p.z) + " starts " + where);
        });
    }
}

}  // namespace

void check_site(const Scene& scene, const std::string& source, Problems& problems) {
    if (!scene.site) return;
    const Site& site = *scene.site;
    problems.attempt([&] { check_model(scene, source); });
    check_ground(scene, source, problems);
    Work work;
    bool all_well = true;
    for (const House& house : site.houses) {
        all_well = problems.attempt([&] { check_house(house, scene, source, work); }) && all_well;
    }
    if (!all_well) return;  // what follows looks for houses
    if (!problems.attempt([&] { check_houses_beside(scene, source); })) return;
    const HouseFinder houses(scene);
    bool ends_well = true;
    for (const Source& made : site.sources)
        ends_well = problems.attempt([&] { check_source(made, scene, houses, source); }) && ends_well;
    const auto check_shape = [&](const MapPolygon& polygon, const MapLine& line, const Limits& limits,
                                 const std::string& label) {
        return problems.attempt([&] {
            check_in_world(polygon, line, limits, scene, label, source);
            if (line.empty()) check_rings(polygon, label, source);
        });
    };
    for (const Outlet& outlet : site.outlets)
        ends_well = check_shape(outlet.polygon, outlet.line, works, outlet.label) && ends_well;
    if (ends_well) check_outlets(scene, source, problems);
    for (const ManningZone& zone : site.roughness.zones) check_shape(zone.polygon, {}, areas, zone.label);
    for (const StandingWater& water : site.water)
        if (!water.polygon.rings.empty()) check_shape(water.polygon, {}, areas, water.label);
    for (const Barrier& barrier : site.barriers) {
        if (check_shape({}, barrier.line, works, barrier.label))
            problems.attempt([&] { check_crest(barrier, site.ground, source); });
    }
    std::set<std::string> names;
    for (const Gauge& gauge : site.gauges) {
        problems.attempt([&] {
            check_gauge(gauge, scene, houses, source);
            if (!names.insert(gauge.name).second)
                refuse_shape(source, gauge.label, gauge.name + " is the name of another gauge, too. Remedy: name it.");
        });
    }
    for (const SiteShelter& shelter : site.shelters) check_shape(shelter.polygon, {}, works, shelter.label);
    problems.attempt([&] { check_crowding(scene, houses, source); });
    check_starts_on_site(scene, houses, source, problems);
}

}  // namespace wade
