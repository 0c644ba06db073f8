#include "fluid_server/particles/bed_profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wade::fluid {

std::vector<BedFacet> bed_facets(const Channel& channel) {
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
        const double length = std::hypot(dx, dy);
        facets.push_back({f(points[k].x), f(points[k + 1].x), f(points[k].x), f(points[k].y), f(-dy / length) + 0.0F,
                          f(dx / length)});
    }
    facets.push_back({f(points.back().x), inf, f(points.back().x), f(points.back().y), 0, 1});
    return facets;
}

const BedFacet& facet_at(const std::vector<BedFacet>& facets, float x) {
    const auto after = std::upper_bound(facets.begin() + 1, facets.end(), x,
                                        [](float value, const BedFacet& facet) { return value < facet.x_lo; });
    return *(after - 1);
}

float bed_height(const std::vector<BedFacet>& facets, float x) {
    return facets.empty() ? 0 : facet_at(facets, x).height(x);
}

}  // namespace wade::fluid
