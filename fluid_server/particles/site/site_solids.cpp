#include "fluid_server/particles/site/site_solids.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "configs/errors/exit_code.hpp"

namespace wade::fluid {

namespace {

// In an oblique corner the velocity that one wall leaves runs into the other one, and a smaller rest into the first. A
// particle that still runs into a wall after so many rounds stops.
constexpr int rounds = 8;
constexpr int rounds_of_places = 3;

// Length of walls beyond open sides, in support radii: a particle that has left the world sees them until removed.
constexpr double beyond_open_sides = 3;

// An approach of less than this share of the contact distance in a step is none.
constexpr float for_rounding = 1e-4F;

// Planes that differ by less are one: normals, and m.
constexpr float same_plane = 2e-6F;

Box box_of(const Wall& wall) {
    const PlanPoint b = wall.end();
    return {{std::min(wall.a.x, b.x), -Box::inf, std::min(wall.a.z, b.z)},
            {std::max(wall.a.x, b.x), Box::inf, std::max(wall.a.z, b.z)}};
}

Box box_of(const MapPolygon& polygon) {
    Box box{{Box::inf, -Box::inf, Box::inf}, {-Box::inf, Box::inf, -Box::inf}};
    for (const MapLine& ring : polygon.rings) {
        for (const MapPoint& p : ring) {
            const auto x = static_cast<float>(p.x), z = static_cast<float>(p.z);
            box.lo[0] = std::min(box.lo[0], x), box.hi[0] = std::max(box.hi[0], x);
            box.lo[2] = std::min(box.lo[2], z), box.hi[2] = std::max(box.hi[2], z);
        }
    }
    return box;
}

// A lower bound of the distance between a wall and a box in plan, m: by the axes, and by the wall's normal.
float distance_to(const Wall& wall, const Box& box) {
    const Box own = box_of(wall);
    const float mx = 0.5F * (box.lo[0] + box.hi[0]), mz = 0.5F * (box.lo[2] + box.hi[2]);
    const float half =
        0.5F * (std::abs(wall.nx) * (box.hi[0] - box.lo[0]) + std::abs(wall.nz) * (box.hi[2] - box.lo[2]));
    const float along_x = std::max(own.lo[0] - box.hi[0], box.lo[0] - own.hi[0]);
    const float along_z = std::max(own.lo[2] - box.hi[2], box.lo[2] - own.hi[2]);
    return std::max({along_x, along_z, std::abs(wall.distance(mx, mz)) - half});
}

// The point of a wall that is nearest to a place, and the way from there, m.
struct Nearest {
    float s = 0;            // along the wall
    float x = 0, z = 0;     // the way
    bool at_end = false;    // beyond an end
    bool has_edge = false;  // beyond one that is an edge
    [[nodiscard]] float distance() const { return std::sqrt(x * x + z * z); }
};
Nearest nearest(const Wall& wall, float x, float z) {
    const float s = wall.along(x, z), on = std::clamp(s, 0.0F, wall.length);
    const PlanPoint foot = wall.at(on);
    return {on, x - foot.x, z - foot.z, on != s, s < 0 ? wall.edge_before : wall.edge_after};
}

bool is_same(const GroundPlane& a, const GroundPlane& b) {
    return std::abs(a.n[0] - b.n[0]) < same_plane && std::abs(a.n[2] - b.n[2]) < same_plane &&
           std::abs(a.c - b.c) < same_plane * std::max(1.0F, std::abs(a.c));
}

}  // namespace

GroundFacets::GroundFacets(const GroundGrid& grid)
    : x(static_cast<float>(grid.x)),
      z(static_cast<float>(grid.z)),
      per_m(static_cast<float>(1 / grid.cell)),
      nx(static_cast<int>(grid.nx)),
      nz(static_cast<int>(grid.nz)) {
    const auto plane = [&](std::size_t i, std::size_t k, double rise_x, double rise_z) {
        const double gx = rise_x / grid.cell, gz = rise_z / grid.cell, down = 1 / std::sqrt(1 + gx * gx + gz * gz);
        const double px = grid.x + static_cast<double>(i) * grid.cell, pz = grid.z + static_cast<double>(k) * grid.cell;
        return GroundPlane{{static_cast<float>(-gx * down), static_cast<float>(down), static_cast<float>(-gz * down)},
                           static_cast<float>(down * (grid.at_node(i, k) - gx * px - gz * pz))};
    };
    if (grid.is_plane) {
        const double along_x = (grid.at_node(grid.nx, 0) - grid.at_node(0, 0)) / static_cast<double>(grid.nx);
        const double along_z = (grid.at_node(0, grid.nz) - grid.at_node(0, 0)) / static_cast<double>(grid.nz);
        planes.push_back(plane(0, 0, along_x, along_z));
        plane_of.assign(2 * grid.nx * grid.nz, 0);
        return;
    }
    for (std::size_t k = 0; k < grid.nz; ++k) {
        for (std::size_t i = 0; i < grid.nx; ++i) {
            const double corner = grid.at_node(i, k), opposite = grid.at_node(i + 1, k + 1);
            const double right = grid.at_node(i + 1, k), up = grid.at_node(i, k + 1);
            for (const GroundPlane& p :
                 {plane(i, k, right - corner, opposite - right), plane(i, k, opposite - up, up - corner)}) {
                const std::size_t t = plane_of.size();
                std::int32_t number = static_cast<std::int32_t>(planes.size());
                for (const std::size_t before :
                     {t % 2 == 1 ? t - 1 : t, i > 0 ? t - t % 2 - 2 : t, k > 0 ? t - t % 2 - 2 * grid.nx + 1 : t}) {
                    if (before < t && is_same(planes[static_cast<std::size_t>(plane_of[before])], p))
                        number = plane_of[before];
                }
                if (static_cast<std::size_t>(number) == planes.size()) planes.push_back(p);
                if (planes.size() > most_planes) {
                    throw ConfigurationError("the ground has more than " + std::to_string(most_planes) +
                                             " planes for particles: a cell of it is 3 /fluid/particle_spacing_m "
                                             "long, or 2 cells of its raster; choose a larger one");
                }
                plane_of.push_back(number);
            }
        }
    }
}

const GroundPlane& GroundFacets::at(float px, float pz) const {
    if (is_one_plane()) return planes[0];
    const float u = std::clamp((px - x) * per_m, 0.0F, static_cast<float>(nx) - 0.5F);
    const float v = std::clamp((pz - z) * per_m, 0.0F, static_cast<float>(nz) - 0.5F);
    const int i = static_cast<int>(u), k = static_cast<int>(v);
    const int upper = v - static_cast<float>(k) > u - static_cast<float>(i) ? 1 : 0;
    return planes[static_cast<std::size_t>(plane_of[static_cast<std::size_t>(2 * (k * nx + i) + upper)])];
}

SiteSolids::SiteSolids(const SiteShape& shape, float support_radius, float spacing)
    : shape_(shape),
      ground_(shape.ground),
      closed_gates_(shape.gates.size() + 1),
      support_radius_(support_radius),
      contact_distance_(contact_fraction * spacing),
      sight_delta_(sight_fraction * spacing) {
    std::vector<Box> houses;
    for (const MapPolygon& house : shape.houses) houses.push_back(box_of(house));
    houses_ = BoxIndex(houses);
    open_gates(0);
}

bool SiteSolids::open_gates(double time) {
    const auto closed = static_cast<std::size_t>(std::count_if(
        shape_.gates.begin(), shape_.gates.end(), [&](const Barrier& gate) { return gate.opens_at > time; }));
    if (closed == closed_gates_) return false;
    closed_gates_ = closed;
    walls_ = walls_of(shape_, time, beyond_open_sides * static_cast<double>(support_radius_));
    std::vector<Box> boxes;
    for (const Wall& wall : walls_) boxes.push_back(grown(box_of(wall), clamp_reach()));
    index_ = BoxIndex(boxes);
    return true;
}

void SiteSolids::find_near(const Box& box, float reach, std::vector<std::uint32_t>& found) const {
    if (walls_.empty()) {
        found.clear();
        return;
    }
    index_.find(grown(box, reach), found);
    std::erase_if(found, [&](std::uint32_t w) { return distance_to(walls_[w], box) >= reach; });
}

void SiteSolids::find_walls(const Box& box, std::vector<std::uint32_t>& found) const {
    find_near(box, support_radius_ + sight_delta_, found);
}

bool SiteSolids::is_near_ground(const Box& box) const {
    const float reach = 1.25F * support_radius_;
    const Vec3 middle{0.5F * (box.lo[0] + box.hi[0]), 0.5F * (box.lo[1] + box.hi[1]), 0.5F * (box.lo[2] + box.hi[2])};
    const auto is_near = [&](const GroundPlane& plane) {
        float nearest = plane.distance(middle);
        for (std::size_t k = 0; k < 3; ++k) nearest -= std::abs(plane.n[k]) * (box.hi[k] - middle[k]);
        return nearest < reach;
    };
    if (ground_.is_one_plane()) return is_near(ground_.planes[0]);
    const Box beside = grown(box, 0.5F * support_radius_);
    const auto cell = [&](float at, float lo, int cells) {
        return static_cast<int>(std::clamp((at - lo) * ground_.per_m, 0.0F, static_cast<float>(cells) - 0.5F));
    };
    for (int k = cell(beside.lo[2], ground_.z, ground_.nz); k <= cell(beside.hi[2], ground_.z, ground_.nz); ++k) {
        for (int i = cell(beside.lo[0], ground_.x, ground_.nx); i <= cell(beside.hi[0], ground_.x, ground_.nx); ++i) {
            const auto lower = static_cast<std::size_t>(2 * (k * ground_.nx + i));
            for (const std::size_t triangle : {lower, lower + 1}) {
                if (is_near(ground_.planes[static_cast<std::size_t>(ground_.plane_of[triangle])])) return true;
            }
        }
    }
    return false;
}

bool SiteSolids::touch_ground(const Vec3& x, float dt, Vec3& v) const {
    bool touched = false;
    // The facet where the particle is, and the one where it goes.
    for (const float way : {0.0F, dt}) {
        const GroundPlane& plane = ground_.at(x[0] + way * v[0], x[2] + way * v[2]);
        const float room = std::max(plane.distance(x) - contact_distance_, 0.0F) / dt;
        const float approach = plane.n[0] * v[0] + plane.n[1] * v[1] + plane.n[2] * v[2] + room;
        if (approach >= 0) continue;
        for (std::size_t k = 0; k < 3; ++k) v[k] -= approach * plane.n[k];
        touched = true;
    }
    return touched;
}

bool SiteSolids::touch_wall(const Wall& wall, const Vec3& x, float dt, Vec3& v) const {
    if (wall.distance(x[0], x[2]) < 0) return false;
    const Nearest from = nearest(wall, x[0], x[2]);
    if (from.at_end && !from.has_edge) return false;  // the wall that goes on there is nearer
    float distance = from.distance();
    float mx = wall.nx, mz = wall.nz;
    const std::uint32_t beyond = from.s > 0 ? wall.after : wall.before;
    if (from.at_end && beyond != Wall::none) {
        // Past an edge the wall with the larger distance to the particle decides, as with boxes.
        const Wall& other = walls_[beyond];
        distance = wall.distance(x[0], x[2]);
        const float next = other.distance(x[0] + dt * v[0], x[2] + dt * v[2]);
        if (other.distance(x[0], x[2]) > distance || next >= contact_distance_) return false;
    } else if (from.at_end && distance > 0) {
        mx = from.x / distance, mz = from.z / distance;
    }
    const float room = std::max(distance - contact_distance_, 0.0F) / dt;
    const float approach = mx * v[0] + mz * v[2] + room;
    if (approach >= -for_rounding * contact_distance_ / dt) return false;
    v[0] -= approach * mx;
    v[2] -= approach * mz;
    return true;
}

void SiteSolids::apply_contact(const Places& x, std::size_t count, float dt, BlockVelocities& v,
                               const OnHouse& on_house) const {
    constexpr std::size_t group = 16;
    thread_local std::vector<std::uint32_t> near;
    for (std::size_t begin = 0; begin < count; begin += group) {
        const std::size_t end = std::min(begin + group, count);
        Box way{{Box::inf, Box::inf, Box::inf}, {-Box::inf, -Box::inf, -Box::inf}};
        for (std::size_t i = begin; i < end; ++i) {
            const float next_x = x.x[i] + dt * v.x[i], next_z = x.z[i] + dt * v.z[i];
            way.lo[0] = std::min({way.lo[0], x.x[i], next_x}), way.hi[0] = std::max({way.hi[0], x.x[i], next_x});
            way.lo[2] = std::min({way.lo[2], x.z[i], next_z}), way.hi[2] = std::max({way.hi[2], x.z[i], next_z});
        }
        find_near(way, 2 * contact_distance_, near);
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3 place{x.x[i], x.y[i], x.z[i]};
            Vec3 u{v.x[i], v.y[i], v.z[i]};
            touch_ground(place, dt, u);
            bool touched = !near.empty();
            for (int round = 0; round < rounds && touched; ++round) {
                touched = false;
                for (const std::uint32_t w : near) {
                    const Vec3 before = u;
                    if (!touch_wall(walls_[w], place, dt, u)) continue;
                    touched = true;
                    if (!on_house || walls_[w].house < 0) continue;
                    on_house(static_cast<std::uint32_t>(walls_[w].house), i,
                             {before[0] - u[0], before[1] - u[1], before[2] - u[2]});
                }
                if (touched) touch_ground(place, dt, u);
            }
            if (touched) u[0] = u[2] = 0, u[1] = std::max(u[1], 0.0F);
            v.x[i] = u[0], v.y[i] = u[1], v.z[i] = u[2];
        }
    }
}

bool SiteSolids::is_water(const Vec3& x) const {
    const MapPoint p{static_cast<double>(x[0]), static_cast<double>(x[2])};
    const auto& open = shape_.open;
    const std::span<const std::uint32_t> houses = houses_.at(x[0], x[2]);
    return (p.x >= shape_.x.lo || open[SiteShape::x_lo]) && (p.x <= shape_.x.hi || open[SiteShape::x_hi]) &&
           (p.z >= shape_.z.lo || open[SiteShape::z_lo]) && (p.z <= shape_.z.hi || open[SiteShape::z_hi]) &&
           std::none_of(houses.begin(), houses.end(), [&](std::uint32_t h) { return contains(shape_.houses[h], p); });
}

bool SiteSolids::clamp(Vec3& x) const {
    const GroundPlane& plane = ground_.at(x[0], x[2]);
    const bool under = plane.distance(x) < 0;
    if (under) x[1] = plane.height(x[0], x[2]);
    const Wall* nearest_wall = nullptr;
    Nearest way;
    for (const std::uint32_t w : index_.at(x[0], x[2])) {
        if (std::abs(walls_[w].distance(x[0], x[2])) > clamp_reach()) continue;
        const Nearest to = nearest(walls_[w], x[0], x[2]);
        if (to.at_end && !to.has_edge) continue;
        if (nearest_wall == nullptr || to.distance() < way.distance()) nearest_wall = &walls_[w], way = to;
    }
    if (nearest_wall == nullptr || nearest_wall->distance(x[0], x[2]) >= 0 || is_water(x)) return under;
    const PlanPoint foot = nearest_wall->at(way.s);
    x[0] = foot.x, x[2] = foot.z;
    return true;
}

void SiteSolids::keep_away(Vec3& x, float distance) const {
    thread_local std::vector<std::uint32_t> near;
    find_near(Box{x, x}, 2 * distance, near);
    for (int round = 0; round < rounds_of_places; ++round) {
        for (const std::uint32_t w : near) {
            const Wall& wall = walls_[w];
            const Nearest to = nearest(wall, x[0], x[2]);
            const float now = to.distance();
            if (wall.distance(x[0], x[2]) < 0 || (to.at_end && !to.has_edge) || now >= distance) continue;
            const bool aside = to.at_end && now > 0;
            x[0] += (distance - now) * (aside ? to.x / now : wall.nx);
            x[2] += (distance - now) * (aside ? to.z / now : wall.nz);
        }
        const GroundPlane& plane = ground_.at(x[0], x[2]);
        const float lack = std::max(distance - plane.distance(x), 0.0F);
        for (std::size_t k = 0; k < 3; ++k) x[k] += lack * plane.n[k];
    }
}

}  // namespace wade::fluid
