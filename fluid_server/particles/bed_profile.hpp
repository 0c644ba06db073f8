#pragma once
// The bed where it is not the plane y = 0: facets between the points of channel.bed_points, level beyond them.

#include <vector>

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
[[nodiscard]] std::vector<BedFacet> bed_facets(const Channel& channel);

// Height of the bed at x, m; 0 without facets.
[[nodiscard]] float bed_height(const std::vector<BedFacet>& facets, float x);

// The facet over which x lies.
[[nodiscard]] const BedFacet& facet_at(const std::vector<BedFacet>& facets, float x);

}  // namespace wade::fluid
