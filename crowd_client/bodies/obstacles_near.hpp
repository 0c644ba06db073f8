#pragma once
// Nearest points of obstacles and houses round a position.

#include <algorithm>
#include <cmath>

#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"
#include "crowd_client/navigation/obstacles.hpp"

namespace wade::crowd {

inline Vector2d nearest_in(const Obstacle& box, const Vector2d& p) {
    return {std::clamp(p.x(), box.x.lo, box.x.hi), std::clamp(p.y(), box.z.lo, box.z.hi)};
}

// Calls visit(way, d) for each obstacle, and each side of a house, less than `reach` away: the vector to its nearest
// point and its length d, m; d > 0.
template <typename Visit>
void for_each_within(const Walls& walls, const Vector2d& p, double reach, Visit&& visit) {
    const Interval x{p.x() - reach, p.x() + reach}, z{p.y() - reach, p.y() + reach};
    for_each_near(walls.boxes, x, z, [&](const Obstacle& box) {
        const Vector2d way = nearest_in(box, p) - p;
        const double d = std::sqrt(way.squaredNorm());
        if (d < reach && d > 0) visit(way, d);
    });
    for_each_side_near(walls.houses, x, z, [&](const HouseSide& side) {
        const double s = side.nearest(p);
        // Beyond a convex corner the next side is nearer, and a body clear of it is clear of this side, too.
        const HouseSide* const next = s <= 0 && side.juts_before            ? &walls.houses.sides[side.before]
                                      : s >= side.length && side.juts_after ? &walls.houses.sides[side.after]
                                                                            : nullptr;
        if (next != nullptr) {
            const double on_next = next->along.dot(p - next->from);
            if (on_next > 0 && on_next < next->length) return;
        }
        const Vector2d way = side.at(s) - p;
        const double d = std::sqrt(way.squaredNorm());
        if (d < reach && d > 0) visit(way, d);
    });
}

}  // namespace wade::crowd
