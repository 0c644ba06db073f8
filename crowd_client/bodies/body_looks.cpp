#include "crowd_client/bodies/body_looks.hpp"

#include <algorithm>
#include <cmath>

namespace wade::crowd {
namespace {

// Sums are of whole numbers, so that they do not depend on the order in which people are stored.
constexpr double per_unit = 0x1p40;

}  // namespace

double share_followed(const Bodies& bodies, std::size_t k, const Vector2d& p) {
    constexpr double reach = 1.5, faces = -0.85;
    const Vector2d& own = bodies.heading[k];
    std::int64_t sum = 0, all = 0;
    bodies.cells.visit_near(p, reach, [&](std::uint32_t j, double dx, double dz) {
        if (j == k || dx * dx + dz * dz >= reach * reach) return;
        const double cosine = own.dot(bodies.heading[j]);
        if (cosine < faces) return;
        sum += static_cast<std::int64_t>(cosine * per_unit);
        ++all;
    });
    return sum > 0 ? static_cast<double>(sum) / per_unit / static_cast<double>(all) : 0.0;
}

double share_opposed(const Bodies& bodies, std::size_t k, const Vector2d& p) {
    constexpr double reach = 2.5, half = 1.0, spread = 0.25;
    const Vector2d &e = bodies.way[k], &bearing = bodies.bearing[k];
    // A box round the strip. It may reach further aside than images do; those are further than anybody looks.
    constexpr double wide = half + spread * reach;
    const auto side = [&](double along, double across) -> Interval {
        return {std::max(-furthest_look, std::min(0.0, reach * along) - wide * std::abs(across)),
                std::min(furthest_look, std::max(0.0, reach * along) + wide * std::abs(across))};
    };
    std::int64_t opposed = 0, all = 0;
    bodies.cells.visit_box(p, side(e.x(), e.y()), side(e.y(), e.x()), [&](std::uint32_t j, double dx, double dz) {
        const double ahead = dx * e.x() + dz * e.y();
        if (j == k || !(ahead > 0) || ahead > reach) return;
        if (std::abs(dx * e.y() - dz * e.x()) > half + spread * ahead) return;
        const double weight = per_unit / (0.5 + ahead);
        all += static_cast<std::int64_t>(weight);
        const double cosine = std::max(e.dot(bodies.way[j]), bearing.dot(bodies.bearing[j]));
        if (cosine < 0) opposed -= static_cast<std::int64_t>(weight * cosine);
    });
    return opposed > 0 ? static_cast<double>(opposed) / static_cast<double>(all) : 0.0;
}

}  // namespace wade::crowd
