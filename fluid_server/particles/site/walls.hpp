#pragma once
// The walls of a site in plan: what separates water from houses, closed gates and the world's closed sides.

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "fluid_server/particles/site/site_shape.hpp"

namespace wade::fluid {

// A place in plan, m.
struct PlanPoint {
    float x = 0, z = 0;
};

// A straight wall from `a` along `u` over `length`, with water on its left, where the normal n points: no ground plan of solids is
// needed to see what is water.
struct Wall {
    static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

    PlanPoint a;
    float ux = 1, uz = 0;
    float nx = 0, nz = 1;
    float length = 0;                            // m
    std::uint32_t before = none, after = none;   // walls that go on from its ends
    std::int32_t house = -1;                     // house that it belongs to, or -1
    bool edge_before = true, edge_after = true;  // water turns by more than a half turn there, or the wall ends in it

    // Of a place in plan from its line, m, positive on the side of the water; and along it from `a` on.
    [[nodiscard]] float distance(float x, float z) const { return nx * (x - a.x) + nz * (z - a.z); }
    [[nodiscard]] float along(float x, float z) const { return ux * (x - a.x) + uz * (z - a.z); }
    [[nodiscard]] PlanPoint at(float s) const { return {a.x + s * ux, a.z + s * uz}; }
    [[nodiscard]] PlanPoint end() const { return at(length); }
};

// All walls at a time, s, each as long as it is straight. Houses may touch and overlap; walls inside of houses are left out.
// margin: how far walls at open sides go on beyond them, m.
[[nodiscard]] std::vector<Wall> walls_of(const SiteShape& shape, double time, double margin);

// How near two walls come, m: one is in front of the other with a part of it, else they see nothing of one another.
[[nodiscard]] float distance_between(const Wall& a, const Wall& b);

}  // namespace wade::fluid
