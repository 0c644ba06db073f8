#pragma once
// The solids of a site: ground of any shape and walls at any angle. As in straight channels both are smooth mirrors and
// keep sheets of water off by contact (solids.hpp); neighbours/billiard.hpp has the visibility of mirror images.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "fluid_server/particles/box_index.hpp"
#include "fluid_server/particles/mirror.hpp"
#include "fluid_server/particles/site/site_shape.hpp"
#include "fluid_server/particles/site/walls.hpp"
#include "fluid_server/particles/solids.hpp"

namespace wade::fluid {

// A plane n . x = c of the ground, n upwards.
struct GroundPlane {
    Vec3 n{0, 1, 0};
    float c = 0;

    bool operator==(const GroundPlane&) const = default;
    // Of a site above the plane, m.
    [[nodiscard]] float distance(const Vec3& x) const { return n[0] * x[0] + n[1] * x[1] + n[2] * x[2] - c; }
    [[nodiscard]] float height(float x, float z) const { return (c - n[0] * x - n[2] * z) / n[1]; }
};

// The triangles of a GroundGrid by their planes; coplanar neighbours share one plane.
struct GroundFacets {
    static constexpr std::size_t most_planes = 33'000'000;

    float x = 0, z = 0, per_m = 1;       // of the first cell, m; cells per m
    int nx = 1, nz = 1;                  // cells
    std::vector<std::int32_t> plane_of;  // triangle 2 (k nx + i), and one more for the upper one
    std::vector<GroundPlane> planes;

    explicit GroundFacets(const GroundGrid& grid);  // throws ConfigurationError of too many planes
    [[nodiscard]] bool is_one_plane() const { return planes.size() == 1; }
    // The plane of the triangle over which a place lies.
    [[nodiscard]] const GroundPlane& at(float px, float pz) const;
};

class SiteSolids {
 public:
    SiteSolids(const SiteShape& shape, float support_radius, float spacing);

    // Walls at a time, s; says whether they are others than before.
    bool open_gates(double time);

    // Replaces `found` by the walls that are nearer in plan to a box than the support radius and sight_delta().
    void find_walls(const Box& box, std::vector<std::uint32_t>& found) const;

    // Whether some plane of the ground under a box, or within half the support radius beside it, is nearer to it than that radius and a
    // quarter, which is more than how far another particle may lie below the plane gone on.
    [[nodiscard]] bool is_near_ground(const Box& box) const;

    // As Solids::apply_contact; calls on_house(its number, particle, the velocity it took away).
    using OnHouse = std::function<void(std::uint32_t, std::size_t, const Vec3&)>;
    void apply_contact(const Places& x, std::size_t count, float dt, BlockVelocities& v,
                       const OnHouse& on_house = {}) const;

    // Moves a place that lies in a wall or under the ground to the nearest free one; true if it had to. A last guard.
    bool clamp(Vec3& x) const;

    // Moves a place so that it is no nearer to walls and ground than this, m, where there is room.
    void keep_away(Vec3& x, float distance) const;

    [[nodiscard]] const std::vector<Wall>& walls() const { return walls_; }
    [[nodiscard]] const GroundFacets& ground() const { return ground_; }
    [[nodiscard]] const SiteShape& shape() const { return shape_; }
    [[nodiscard]] bool is_water(const Vec3& x) const;
    // Half the width over which sight fades at an edge, m.
    [[nodiscard]] float sight_delta() const { return sight_delta_; }

 private:
    void find_near(const Box& box, float reach, std::vector<std::uint32_t>& found) const;
    // Whether these had to change the velocity.
    bool touch_ground(const Vec3& x, float dt, Vec3& v) const;
    bool touch_wall(const Wall& wall, const Vec3& x, float dt, Vec3& v) const;

    // Places farther behind a wall than this, m, are not put back: contact leaves none there.
    [[nodiscard]] float clamp_reach() const { return 2 * contact_distance_; }

    SiteShape shape_;
    GroundFacets ground_;
    std::size_t closed_gates_ = 0;
    std::vector<Wall> walls_;
    BoxIndex index_;   // of the walls, by boxes that reach as far round them as places are put back
    BoxIndex houses_;  // of them in plan
    float support_radius_, contact_distance_, sight_delta_;
};

}  // namespace wade::fluid
