#pragma once
// The bed where it is not the plane y = 0: facets between the points of channel.bed_points, level beyond them.

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "configs/numbers/portable.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/scene.hpp"

namespace wade::fluid {

// The part x_lo <= x <= x_hi of a plane through (px, py) with the upward unit normal (nx, ny).
struct BedFacet {
    float x_lo = 0, x_hi = 0;  // m, infinite at the ends
    float px = 0, py = 0;      // m
    float nx = 0, ny = 1;

    [[nodiscard]] bool level() const { return nx == 0; }
    // Distance of a point from the plane, m, positive above.
    [[nodiscard]] float distance(float x, float y) const { return nx * (x - px) + ny * (y - py); }
    [[nodiscard]] float height(float x) const { return py - nx / ny * (x - px); }
};

// Ascending in x; none if the scene's bed is level at y = 0.
[[nodiscard]] inline std::vector<BedFacet> bed_facets(const Channel& channel) {
    const std::vector<BedPoint>& points = channel.bed_points;
    if (points.empty()) {
        return {};
    }
    constexpr float inf = std::numeric_limits<float>::infinity();
    const auto f = [](double v) { return static_cast<float>(v); };
    std::vector<BedFacet> facets;
    facets.push_back({-inf, f(points.front().x), f(points.front().x), f(points.front().y), 0, 1});
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
        const double dx = points[k + 1].x - points[k].x;
        const double dy = points[k + 1].y - points[k].y;
        const double length = length_of(dx, dy);
        facets.push_back({f(points[k].x), f(points[k + 1].x), f(points[k].x), f(points[k].y), f(-dy / length) + 0.0F,
                          f(dx / length)});
    }
    facets.push_back({f(points.back().x), inf, f(points.back().x), f(points.back().y), 0, 1});
    return facets;
}

// The facet over which x lies.
[[nodiscard]] inline const BedFacet& facet_at(const std::vector<BedFacet>& facets, float x) {
    const auto after = std::upper_bound(facets.begin() + 1, facets.end(), x,
                                        [](float value, const BedFacet& facet) { return value < facet.x_lo; });
    return *(after - 1);
}

// Height of the bed at x, m; 0 without facets.
[[nodiscard]] inline float bed_height(const std::vector<BedFacet>& facets, float x) {
    return facets.empty() ? 0 : facet_at(facets, x).height(x);
}

}  // namespace wade::fluid
