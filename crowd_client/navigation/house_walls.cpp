// Steps that slide along houses of any ground plan.
//
// A step ends where it would come nearer to a side than `skin`. The rest of the step loses its component across that
// side, and continues. A segment is accepted only if it meets no side and ends at least half a skin from all sides, so
// that rounding moves no agent into a house.

#include <algorithm>
#include <cmath>
#include <utility>

#include "configs/scene/interval.hpp"
#include "crowd_client/navigation/obstacles.hpp"

namespace wade::crowd {
namespace {

constexpr double skin = Walls::skin, min_gap = 0.5 * Walls::skin;

struct Touch {
    double time = 2;  // in units of the segment, [0, 1]; 2: none
    const HouseSide* side = nullptr;
};

// Finds when the segment at + t rest first is within a skin of the side, in front of it.
Touch touch_of(const HouseSide& side, const Vector2d& at, const Vector2d& rest) {
    const double here = side.distance_before(at), lost = -side.outward.dot(rest), there = here - lost;
    if (here < 0 || !(lost > 0) || there >= min_gap) return {};
    const double first = std::max(0.0, (here - skin) / lost), last = std::min(1.0, here / lost);
    const double s_first = side.along.dot(at + first * rest - side.from);
    const double s_last = side.along.dot(at + last * rest - side.from);
    const double lo = -skin, hi = side.length + skin;
    if (std::max(s_first, s_last) < lo || std::min(s_first, s_last) > hi) return {};
    if (s_first >= lo && s_first <= hi) return {first, &side};
    const double bound = s_first < lo ? lo : hi;
    return {first + (last - first) * (bound - s_first) / (s_last - s_first), &side};
}

Interval side_range(double a, double b) {
    return {std::min(a, b) - 2 * skin, std::max(a, b) + 2 * skin};
}

bool is_clear(const PlacedHouses& houses, const Vector2d& from, const Vector2d& to) {
    return !any_side_near(
        houses, side_range(from.x(), to.x()), side_range(from.y(), to.y()), [&](const HouseSide& side) {
            return meets(side, from, to) || (to - side.at(side.nearest(to))).squaredNorm() < 0.8 * min_gap * min_gap;
        });
}

}  // namespace

Vector2d slide_along_houses(const Walls& walls, const Vector2d& p, const Vector2d& displacement, const Interval& ends) {
    const auto in_world = [&](const Vector2d& place) {
        return Vector2d(std::clamp(place.x(), ends.lo, ends.hi), std::clamp(place.y(), 0.0, walls.world.width));
    };
    constexpr int max_turns = 8;
    Vector2d at = p, target = in_world(p + displacement);
    for (int turn = 0; turn < max_turns && at != target; ++turn) {
        const Vector2d rest = target - at;
        Touch touch;
        for_each_side_near(walls.houses, side_range(at.x(), target.x()), side_range(at.y(), target.y()),
                           [&](const HouseSide& side) {
                               const Touch here = touch_of(side, at, rest);
                               if (here.time < touch.time) touch = here;
                           });
        if (touch.side == nullptr) return is_clear(walls.houses, at, target) ? target : at;
        Vector2d place = at + touch.time * rest;
        place += std::max(0.0, skin - touch.side->distance_before(place)) * touch.side->outward;
        if (!is_clear(walls.houses, at, place)) return at;
        at = place;
        const Vector2d left = target - place;
        target = in_world(place + left + std::max(0.0, -touch.side->outward.dot(left)) * touch.side->outward);
    }
    return at;
}

std::optional<Vector2d> place_before_houses(const PlacedHouses& houses, const Vector2d& p) {
    const Interval x = side_range(p.x(), p.x()), z = side_range(p.y(), p.y());
    Vector2d place = p;
    bool is_near = false;
    for_each_side_near(houses, x, z, [&](const HouseSide& side) {
        if ((p - side.at(side.nearest(p))).norm() >= skin) return;
        is_near = true;
        place += std::max(0.0, 1.5 * skin - side.distance_before(place)) * side.outward;
    });
    if (is_in_a_house(houses, place)) return std::nullopt;
    return is_near && !is_clear(houses, place, place) ? std::nullopt : std::optional(place);
}

}  // namespace wade::crowd
