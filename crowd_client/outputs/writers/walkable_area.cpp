// Where people can walk, in well-known text: the geometry of trajectory files.

// Coordinates begin at the place's origin, so that they need no rescaling.
#define BOOST_GEOMETRY_NO_ROBUSTNESS

#include <algorithm>
#include <boost/geometry.hpp>
#include <boost/geometry/geometries/multi_polygon.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/polygon.hpp>
#include <span>
#include <string>

#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/place.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/outputs/writers/trajectory_file.hpp"
#include "crowd_client/results/output_file.hpp"

namespace wade::crowd {
namespace {

namespace geometry = boost::geometry;
using Point = geometry::model::d2::point_xy<double>;
using Polygon = geometry::model::polygon<Point, false>;
using Polygons = geometry::model::multi_polygon<Polygon>;

std::string ring(const Interval& x, const Interval& z) {
    const std::string x0 = csv_number(x.lo), x1 = csv_number(x.hi), z0 = csv_number(z.lo), z1 = csv_number(z.hi);
    return "(" + x0 + " " + z0 + ", " + x1 + " " + z0 + ", " + x1 + " " + z1 + ", " + x0 + " " + z1 + ", " + x0 + " " +
           z0 + ")";
}

bool touch(const Interval& a, const Interval& b) {
    return a.lo <= b.hi && b.lo <= a.hi;
}

bool may_be_a_hole(const Scene& scene, const Obstacle& o) {
    if (o.x.lo <= 0 || o.z.lo <= 0 || o.x.hi >= scene.world->length || o.z.hi >= scene.world->width) return false;
    return std::none_of(scene.obstacles.begin(), scene.obstacles.end(), [&](const Obstacle& other) {
        return &other != &o && touch(o.x, other.x) && touch(o.z, other.z);
    });
}

Polygons plan_of(const House& house) {
    Polygons plan;
    for (const MapLine& line : house.polygon.rings) {
        Polygon one;
        for (const MapPoint& p : line) one.outer().emplace_back(p.x, p.z);
        geometry::correct(one);
        Polygons with;
        geometry::sym_difference(plan, one, with);  // what lies in an even number of rings is no house
        plan = std::move(with);
    }
    return plan;
}

// Halves first, so that each joint is of few corners.
Polygons joined(std::span<const House> houses) {
    if (houses.size() == 1) return plan_of(houses.front());
    const std::size_t half = houses.size() / 2;
    Polygons all;
    geometry::union_(joined(houses.first(half)), joined(houses.subspan(half)), all);
    return all;
}

std::string ring(const Polygon::ring_type& line) {
    std::string text;
    for (const Point& p : line) text += (text.empty() ? "(" : ", ") + csv_number(p.x()) + " " + csv_number(p.y());
    return text + ")";
}

// The world less the houses of a place: the largest of its parts.
std::string streets_wkt(const World& world, std::span<const House> houses) {
    Polygon ground;
    geometry::convert(geometry::model::box<Point>({0, 0}, {world.length, world.width}), ground);
    Polygons parts;
    geometry::difference(ground, joined(houses), parts);
    if (parts.empty()) return "POLYGON EMPTY";
    const auto area = [](const Polygon& part) { return geometry::area(part); };
    const Polygon& largest = *std::ranges::max_element(parts, {}, area);
    std::string text = "POLYGON (" + ring(largest.outer());
    for (const auto& hole : largest.inners()) text += ", " + ring(hole);
    return text + ")";
}

}  // namespace

std::string walkable_area_wkt(const Scene& scene) {
    constexpr double inset = 1e-3;  // m
    const World& world = scene.world;
    if (scene.place && !scene.place->houses.empty()) return streets_wkt(world, scene.place->houses);
    std::string wkt = "POLYGON (" + ring({0, world.length}, {0, world.width});
    for (const Obstacle& o : scene.obstacles) {
        Interval x{std::max(o.x.lo, 0.0), std::min(o.x.hi, world.length)};
        Interval z{std::max(o.z.lo, 0.0), std::min(o.z.hi, world.width)};
        if (!may_be_a_hole(scene, o)) {
            x = {x.lo + inset, x.hi - inset};
            z = {z.lo + inset, z.hi - inset};
        }
        if (x.lo < x.hi && z.lo < z.hi) wkt += ", " + ring(x, z);
    }
    return wkt + ")";
}

}  // namespace wade::crowd
