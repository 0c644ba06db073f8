#include "crowd_client/markers/placed_houses.hpp"

#include <cmath>
#include <utility>

#include "configs/scene/obstacle.hpp"

namespace wade::crowd {
namespace {

constexpr double cell_of_grounds = 8, cell_of_pieces = 2;  // m; size of a house, and of a step with its surroundings
constexpr double longest_piece = 4;     // m; a rectangle round more would hold far more than the side
constexpr double shortest_side = 1e-9;  // m

double cross(const Vector2d& a, const Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

Vector2d vector_of(const MapPoint& p) {
    return {p.x, p.z};
}

Obstacle rectangle_round(const Vector2d& a, const Vector2d& b) {
    const auto [lo_x, hi_x] = std::minmax(a.x(), b.x());
    const auto [lo_z, hi_z] = std::minmax(a.y(), b.y());
    return {{lo_x, hi_x}, {lo_z, hi_z}};
}

double doubled_area(const MapLine& ring) {
    double sum = 0;
    for (std::size_t k = 0, last = ring.size() - 1; k < ring.size(); last = k++) {
        sum += cross(vector_of(ring[last]) - vector_of(ring[0]), vector_of(ring[k]) - vector_of(ring[0]));
    }
    return sum;
}

bool is_court(const MapPolygon& plan, std::size_t ring_number) {
    std::size_t round_it = 0;
    for (std::size_t other = 0; other < plan.rings.size(); ++other) {
        if (other != ring_number && contains({{plan.rings[other]}}, plan.rings[ring_number][0])) ++round_it;
    }
    return round_it % 2 == 1;
}

// Returns the corners with the house on the left along them: an outer ring counter-clockwise, a court's clockwise.
std::vector<Vector2d> corners_of(const MapLine& ring, bool of_court) {
    std::vector<Vector2d> corners;
    for (const MapPoint& p : ring) {
        if (corners.empty() || (vector_of(p) - corners.back()).norm() > shortest_side) corners.push_back(vector_of(p));
    }
    while (corners.size() > 1 && (corners.back() - corners.front()).norm() <= shortest_side) corners.pop_back();
    if ((doubled_area(ring) > 0) == of_court) std::reverse(corners.begin(), corners.end());
    return corners;
}

void add_ring(std::vector<HouseSide>& sides, const std::vector<Vector2d>& corners, bool of_court) {
    if (corners.size() < 3) return;
    const std::size_t first = sides.size(), n = corners.size();
    for (std::size_t k = 0; k < n; ++k) {
        HouseSide side;
        side.is_of_court = of_court;
        side.from = corners[k];
        side.to = corners[(k + 1) % n];
        side.length = (side.to - side.from).norm();
        side.along = (side.to - side.from) / side.length;
        side.outward = {side.along.y(), -side.along.x()};
        side.before = static_cast<std::uint32_t>(first + (k + n - 1) % n);
        side.after = static_cast<std::uint32_t>(first + (k + 1) % n);
        sides.push_back(side);
    }
    for (std::size_t k = first; k < sides.size(); ++k) {
        HouseSide& next = sides[sides[k].after];
        sides[k].juts_after = next.juts_before = cross(sides[k].along, next.along) > 0;
    }
}

}  // namespace

PlacedHouses place_houses(std::vector<MapPolygon> plans) {
    PlacedHouses houses;
    houses.plans = std::move(plans);
    std::vector<Obstacle> grounds, pieces;
    for (const MapPolygon& plan : houses.plans) {
        houses.first_side.push_back(static_cast<std::uint32_t>(houses.sides.size()));
        for (std::size_t r = 0; r < plan.rings.size(); ++r) {
            if (plan.rings[r].empty()) continue;
            const bool of_court = is_court(plan, r);
            add_ring(houses.sides, corners_of(plan.rings[r], of_court), of_court);
        }
        Obstacle ground{{0, 0}, {0, 0}};
        for (std::size_t k = houses.first_side.back(); k < houses.sides.size(); ++k) {
            const HouseSide& side = houses.sides[k];
            const Obstacle here = rectangle_round(side.from, side.to);
            ground = k == houses.first_side.back()
                         ? here
                         : Obstacle{{std::min(ground.x.lo, here.x.lo), std::max(ground.x.hi, here.x.hi)},
                                    {std::min(ground.z.lo, here.z.lo), std::max(ground.z.hi, here.z.hi)}};
            const double count = std::ceil(side.length / longest_piece);
            for (int i = 0; i < static_cast<int>(count); ++i) {
                pieces.push_back(
                    rectangle_round(side.at(side.length * i / count), side.at(side.length * (i + 1) / count)));
                houses.side_of.push_back(static_cast<std::uint32_t>(k));
            }
        }
        grounds.push_back(ground);
    }
    houses.first_side.push_back(static_cast<std::uint32_t>(houses.sides.size()));
    houses.grounds = place_boxes(std::move(grounds), cell_of_grounds);
    houses.pieces = place_boxes(std::move(pieces), cell_of_pieces);
    return houses;
}

PlacedHouses houses_of(const Scene& scene) {
    if (!scene.site) return {};
    std::vector<MapPolygon> plans;
    for (const House& house : scene.site->houses) plans.push_back(house.polygon);
    for (const Obstacle& o : scene.obstacles) {
        plans.push_back({{{{o.x.lo, o.z.lo}, {o.x.hi, o.z.lo}, {o.x.hi, o.z.hi}, {o.x.lo, o.z.hi}}}});
    }
    for (const Barrier& barrier : scene.site->barriers) {
        if (!barrier.plan.rings.empty()) plans.push_back(barrier.plan);
    }
    return place_houses(std::move(plans));
}

bool is_in_a_house(const PlacedHouses& houses, const Vector2d& p) {
    return any_near(houses.grounds, {p.x(), p.x()}, {p.y(), p.y()}, [&](const Obstacle& ground) {
        return contains(houses.plan_on(ground), {p.x(), p.y()});
    });
}

bool meets(const HouseSide& side, const Vector2d& p, const Vector2d& q) {
    constexpr double rounding = 1e-9;  // m
    const double here = side.distance_before(p), there = side.distance_before(q);
    if ((here > 0 && there > 0) || (here < 0 && there < 0)) return false;
    const double s_here = side.along.dot(p - side.from), s_there = side.along.dot(q - side.from);
    if (here == there) {  // along the side's line
        return std::max(s_here, s_there) >= -rounding && std::min(s_here, s_there) <= side.length + rounding;
    }
    const double s = s_here + (s_there - s_here) * (here / (here - there));
    return s >= -rounding && s <= side.length + rounding;
}

double distance_between(const HouseSide& side, const Vector2d& p, const Vector2d& q) {
    if (meets(side, p, q)) return 0;
    const Vector2d way = q - p;
    const double square = way.squaredNorm();
    const auto to_way = [&](const Vector2d& corner) {
        const double t = square > 0 ? std::clamp((corner - p).dot(way) / square, 0.0, 1.0) : 0;
        return (corner - p - t * way).squaredNorm();
    };
    const auto to_side = [&](const Vector2d& end) { return (end - side.at(side.nearest(end))).squaredNorm(); };
    return std::sqrt(std::min(std::min(to_way(side.from), to_way(side.to)), std::min(to_side(p), to_side(q))));
}

bool meets_a_house(const PlacedHouses& houses, const Vector2d& p, const Vector2d& q) {
    const auto [lo_x, hi_x] = std::minmax(p.x(), q.x());
    const auto [lo_z, hi_z] = std::minmax(p.y(), q.y());
    return any_side_near(houses, {lo_x, hi_x}, {lo_z, hi_z}, [&](const HouseSide& side) { return meets(side, p, q); });
}

}  // namespace wade::crowd
