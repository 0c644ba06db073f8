#include "configs/files/polygon_validity.hpp"

#include <algorithm>
#include <boost/geometry/algorithms/buffer.hpp>
#include <boost/geometry/algorithms/correct.hpp>
#include <boost/geometry/algorithms/envelope.hpp>
#include <boost/geometry/algorithms/intersects.hpp>
#include <boost/geometry/algorithms/is_valid.hpp>
#include <boost/geometry/algorithms/num_points.hpp>
#include <boost/geometry/algorithms/relate.hpp>
#include <boost/geometry/core/exception.hpp>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/linestring.hpp>
#include <boost/geometry/geometries/multi_polygon.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/polygon.hpp>
#include <boost/geometry/strategies/strategies.hpp>
#include <cstdio>

namespace wade {

namespace {

namespace bg = boost::geometry;
using Corner = bg::model::d2::point_xy<double>;
using Part = bg::model::polygon<Corner, false, false>;  // counterclockwise, the last corner joined to the first

// Coordinates are relative to `origin`, so that few digits tell a point.
std::vector<Part> shape_of(const std::vector<MapPolygon>& parts, const MapPoint& origin) {
    std::vector<Part> shape;
    for (const MapPolygon& part : parts) {
        if (part.rings.empty()) continue;
        shape.emplace_back();
        shape.back().inners().resize(part.rings.size() - 1);
        for (std::size_t i = 0; i < part.rings.size(); ++i) {
            auto& ring = i == 0 ? shape.back().outer() : shape.back().inners()[i - 1];
            for (const MapPoint& p : part.rings[i]) ring.emplace_back(p.x - origin.x, p.z - origin.z);
        }
    }
    for (Part& part : shape) bg::correct(part);  // either sense of rotation is allowed
    return shape;
}

std::string words_of(bg::validity_failure_type failure) {
    switch (failure) {
        case bg::failure_spikes:
            return "its outline has a spike, edges that run there and back";
        case bg::failure_interior_rings_outside:
            return "a hole lies outside of its outline";
        case bg::failure_nested_interior_rings:
            return "its holes lie within one another";
        case bg::failure_disconnected_interior:
            return "its holes cut it into several parts";
        case bg::failure_self_intersections:
            return "its outline crosses or touches itself";
        default:
            return "its outline crosses itself or encloses no area";
    }
}

// Parts may share an edge, as those of one house do that are drawn beside one another.
std::string fault_of_pairs(const std::vector<Part>& shape, std::size_t& work_left, const std::string& remedy,
                           const std::string& tangled) {
    std::vector<bg::model::box<Corner>> boxes;
    boxes.reserve(shape.size());
    for (const Part& part : shape) boxes.push_back(bg::return_envelope<bg::model::box<Corner>>(part));
    const bg::de9im::mask interiors_meet("T********");
    for (std::size_t k = 1; k < shape.size(); ++k) {
        for (std::size_t i = 0; i < k; ++i) {
            const std::size_t steps =
                bg::intersects(boxes[i], boxes[k]) ? 20 * (bg::num_points(shape[i]) + bg::num_points(shape[k])) : 1;
            if (steps > work_left) return tangled;
            work_left -= steps;
            if (steps > 1 && bg::relate(shape[i], shape[k], interiors_meet))
                return "its parts " + std::to_string(i) + " and " + std::to_string(k) + " lie on one another" + remedy;
        }
    }
    return "";
}

}  // namespace

// Counts the pairs of edges that share an x, as a bound of what the check costs; returns false for too many.
bool PolygonValidity::take_work(const std::vector<MapPolygon>& parts) {
    std::vector<double> starts, ends;
    for (const MapPolygon& part : parts) {
        for (const MapLine& ring : part.rings) {
            for (std::size_t k = 0; k < ring.size(); ++k) {
                const double a = ring[k].x, b = ring[(k + 1) % ring.size()].x;
                starts.push_back(std::min(a, b));
                ends.push_back(std::max(a, b));
            }
        }
    }
    std::sort(starts.begin(), starts.end());
    std::sort(ends.begin(), ends.end());
    std::size_t ended = 0;
    for (std::size_t i = 0; i < starts.size(); ++i) {
        while (ends[ended] < starts[i]) ++ended;
        const std::size_t pairs = i - ended + 1;
        if (pairs > work_left_) return false;
        work_left_ -= pairs;
    }
    return true;
}

MapPolygon widened(const MapLine& line, double width) {
    namespace by = bg::strategy::buffer;
    const MapPoint origin = line.front();
    bg::model::linestring<Corner> middle;
    for (const MapPoint& p : line) middle.emplace_back(p.x - origin.x, p.z - origin.z);
    bg::model::multi_polygon<Part> parts;
    bg::buffer(middle, parts, by::distance_symmetric<double>(0.5 * width), by::side_straight(), by::join_miter(),
               by::end_flat(), by::point_square());
    MapPolygon polygon;
    const auto add = [&](const auto& ring) {
        MapLine& corners = polygon.rings.emplace_back();
        for (const Corner& corner : ring) corners.push_back({origin.x + corner.x(), origin.z + corner.y()});
    };
    for (const Part& part : parts) {
        add(part.outer());
        for (const auto& hole : part.inners()) add(hole);
    }
    return polygon;
}

std::string PolygonValidity::fault_of(const std::vector<MapPolygon>& parts) {
    const std::string tangled =
        "its outline is too long or too tangled to be checked. Remedy: tools/wade site import, or ogr2ogr -simplify "
        "0.1.";
    const std::string remedy = ". Remedy: draw its corners in order, tools/wade site import, or ogr2ogr -makevalid.";
    if (!take_work(parts)) return tangled;
    try {
        const bool has_corner = !parts.empty() && !parts[0].rings.empty() && !parts[0].rings[0].empty();
        const MapPoint origin = has_corner ? parts[0].rings[0][0] : MapPoint{};
        const std::vector<Part> shape = shape_of(parts, origin);
        for (const Part& part : shape) {
            bg::validity_failure_type failure = bg::no_failure;
            if (bg::is_valid(part, failure)) continue;
            std::string reason;
            static_cast<void>(bg::is_valid(part, reason));  // tells the point
            double x = 0, z = 0;
            const std::size_t point = std::min(reason.find('('), reason.size());
            const bool has_point = std::sscanf(reason.c_str() + point, "(%lf, %lf)", &x, &z) == 2;
            return words_of(failure) +
                   (has_point ? " at x " + std::to_string(origin.x + x) + ", y " + std::to_string(origin.z + z) : "") +
                   remedy;
        }
        return fault_of_pairs(shape, work_left_, remedy, tangled);
    } catch (const bg::exception&) {
        return tangled;
    }
}

}  // namespace wade
