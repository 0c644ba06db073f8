#include "crowd_client/navigation/sight.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"

namespace wade::crowd {
namespace {

constexpr double rounding = 1e-9;  // m, so that a point on a face does not count as inside

// Returns the distance along the axis with the larger gap; below 0 for a position inside.
double distance_to(const Obstacle& box, const Vector2d& p) {
    return std::max(std::max(box.x.lo - p.x(), p.x() - box.x.hi), std::max(box.z.lo - p.y(), p.y() - box.z.hi));
}

// Cuts [t_in, t_out] down to where p + t d is strictly between lo and hi; false if nothing is left.
bool cut(double p, double d, const Interval& side, double& t_in, double& t_out) {
    if (d == 0) return side.lo < p && p < side.hi;
    const double t_lo = (side.lo - p) / d, t_hi = (side.hi - p) / d;
    t_in = std::max(t_in, std::min(t_lo, t_hi));
    t_out = std::min(t_out, std::max(t_lo, t_hi));
    return t_in < t_out;
}

// The rectangle around p and q, grown by a margin.
struct Rectangle {
    Interval x, z;
};
Rectangle round_both(const Vector2d& p, const Vector2d& q, double margin_x, double margin_z) {
    const auto [lo_x, hi_x] = std::minmax(p.x(), q.x());
    const auto [lo_z, hi_z] = std::minmax(p.y(), q.y());
    return {{lo_x - margin_x, hi_x + margin_x}, {lo_z - margin_z, hi_z + margin_z}};
}

// Returns whether a test holds for a box nearer to the segment from p to q than the margins. Tests boxes in no order
// and perhaps more than once. Divides the segment into pieces, because one rectangle around it would hold far more
// boxes.
template <typename Test>
bool any_along(const PlacedBoxes& boxes, const Vector2d& p, const Vector2d& q, double margin_x, double margin_z,
               Test&& test) {
    if (boxes.all.empty()) return false;
    margin_x += rounding;
    margin_z += rounding;
    const Vector2d way = q - p;
    const double left_x = boxes.cell - 2 * margin_x, left_z = boxes.cell - 2 * margin_z;
    const double least = 0.25 * boxes.cell;
    const double pieces = std::ceil(
        std::max({std::abs(way.x()) / std::max(left_x, least), std::abs(way.y()) / std::max(left_z, least), 1.0}) +
        rounding);
    if (pieces >= static_cast<double>(boxes.all.size())) return std::any_of(boxes.all.begin(), boxes.all.end(), test);
    const int count = static_cast<int>(pieces);
    for (int i = 0; i < count; ++i) {
        const Rectangle piece = round_both(p + (i / pieces) * way, p + ((i + 1) / pieces) * way, margin_x, margin_z);
        if (any_near(boxes, piece.x, piece.z, test)) return true;
    }
    return false;
}

// Returns whether the segment from p to q comes nearer to a side of a house than a margin, m.
bool comes_near_a_house(const PlacedHouses& houses, double margin, const Vector2d& p, const Vector2d& q) {
    if (houses.empty()) return false;
    const double reach = std::max(margin, 0.0) + rounding;
    return any_along(houses.pieces, p, q, reach, reach, [&](const Obstacle& piece) {
        const std::size_t side = houses.side_of[static_cast<std::size_t>(&piece - houses.pieces.all.data())];
        const double distance = distance_between(houses.sides[side], p, q);
        return distance < margin || distance == 0;
    });
}

// Returns the clearance, or less if an end of the segment is nearer to a box.
double margin_at_ends(const Sight& sight, const Vector2d& p, const Vector2d& q) {
    return std::min(margin_from(sight, p), margin_from(sight, q));
}

}  // namespace

double margin_from(const Sight& sight, const Vector2d& p) {
    double margin = sight.clearance;
    const double reach = sight.clearance + 2 * rounding;
    const Rectangle near = round_both(p, p, reach, reach);
    for_each_near(sight.boxes, near.x, near.z, [&](const Obstacle& box) { margin = margin_at(box, margin, p); });
    for_each_side_near(sight.houses, near.x, near.z, [&](const HouseSide& side) {
        margin = std::min(margin, (p - side.at(side.nearest(p))).norm() - rounding);
    });
    return margin;
}

bool sees_with(const Sight& sight, double margin, const Vector2d& p, const Vector2d& q) {
    const double reach = sight.clearance + rounding;
    return !any_along(sight.boxes, p, q, reach, reach, [&](const Obstacle& box) {
        return crosses(grown(box, margin), p, q);
    }) && !comes_near_a_house(sight.houses, margin, p, q);
}

Obstacle grown(const Obstacle& box, double margin) {
    return {{box.x.lo - margin, box.x.hi + margin}, {box.z.lo - margin, box.z.hi + margin}, box.height};
}

bool crosses(const Obstacle& box, const Vector2d& p, const Vector2d& q) {
    // Most segments lie on one side of the box; the divisions below would find the same.
    const auto beside = [](double a, double b, const Interval& side) {
        return (a <= side.lo && b <= side.lo) || (a >= side.hi && b >= side.hi);
    };
    if (beside(p.x(), q.x(), box.x) || beside(p.y(), q.y(), box.z)) return false;
    double t_in = 0, t_out = 1;
    return cut(p.x(), q.x() - p.x(), box.x, t_in, t_out) && cut(p.y(), q.y() - p.y(), box.z, t_in, t_out);
}

double margin_at(const Obstacle& box, double clearance, const Vector2d& p) {
    return std::min(clearance, distance_to(box, p) - rounding);
}

bool in_sight(const Sight& sight, const Vector2d& p, const Vector2d& q) {
    return sees_with(sight, margin_at_ends(sight, p, q), p, q);
}

// A point visible with the whole clearance is visible with less, and most often the clearance is whole.
bool in_sight(const Sight& sight, const Vector2d& p, const Vector2d& q, std::span<const std::uint32_t> hiding) {
    const auto keeps = [&](double margin) {
        return std::none_of(hiding.begin(), hiding.end(),
                            [&](std::uint32_t i) { return crosses(grown(sight.boxes.all[i], margin), p, q); });
    };
    if (keeps(sight.clearance)) return true;
    const double margin = margin_at_ends(sight, p, q);
    return margin < sight.clearance && keeps(margin);
}

// in_sight: all segments from the rectangle to the goal lie within half its sides of the segment from its middle.
// hidden: the positions that a convex box hides from the goal form a convex set. A box that hides the four corners
// hides all positions between them. The test uses the bare box, because the clearance shrinks for positions near it.
View view_of(const Sight& sight, const Interval& x, const Interval& z, const Vector2d& goal,
             std::vector<std::uint32_t>* hiding) {
    const std::size_t before = hiding != nullptr ? hiding->size() : 0;
    const Vector2d middle(0.5 * (x.lo + x.hi), 0.5 * (z.lo + z.hi));
    const double half_x = 0.5 * (x.hi - x.lo) + sight.clearance, half_z = 0.5 * (z.hi - z.lo) + sight.clearance;
    const std::array<Vector2d, 4> corners{Vector2d(x.lo, z.lo), Vector2d(x.hi, z.lo), Vector2d(x.lo, z.hi),
                                          Vector2d(x.hi, z.hi)};
    View view = View::in_sight;
    const bool is_hidden = any_along(sight.boxes, middle, goal, half_x, half_z, [&](const Obstacle& box) {
        const Obstacle wide{{box.x.lo - half_x, box.x.hi + half_x}, {box.z.lo - half_z, box.z.hi + half_z}, box.height};
        if (!crosses(wide, middle, goal)) return false;
        view = View::unknown;
        if (hiding != nullptr) hiding->push_back(static_cast<std::uint32_t>(&box - sight.boxes.all.data()));
        return std::all_of(corners.begin(), corners.end(),
                           [&](const Vector2d& corner) { return crosses(grown(box, -rounding), corner, goal); });
    });
    if (hiding != nullptr) {
        // Some boxes were tested more than once.
        const auto first = hiding->begin() + static_cast<std::ptrdiff_t>(before);
        std::sort(first, hiding->end());
        hiding->erase(is_hidden ? first : std::unique(first, hiding->end()), hiding->end());
    }
    return is_hidden ? View::hidden : view;
}

}  // namespace wade::crowd
