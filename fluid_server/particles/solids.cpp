#include "fluid_server/particles/solids.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "configs/scene/scene_capacity.hpp"

namespace wade::fluid {

namespace {

// A particle stands for a cube of side d; its centre may come as near to a face as this fraction of d. Pressure keeps
// a filled layer at about d/2, so that contact acts on thin sheets only.
constexpr float contact_fraction = 0.4F;

// Obstacles are looked for within so many support radii: an eighth more than the longest line of sight, which is far more than
// what rounding moves.
constexpr float search_radii = 1.125F;

Box interior_of(const Channel& channel) {
    Box box;
    box.lo[1] = channel.top == Top::periodic || !channel.bed_points.empty() ? -Box::inf : 0;
    box.hi[1] = channel.top == Top::wall ? static_cast<float>(channel.height) : Box::inf;
    if (channel.flow == Flow::closed) {
        box.lo[0] = static_cast<float>(channel.x.lo);
        box.hi[0] = static_cast<float>(channel.x.hi);
    }
    if (channel.sides == Sides::walls) {
        box.lo[2] = static_cast<float>(channel.z.lo);
        box.hi[2] = static_cast<float>(channel.z.hi);
    }
    return box;
}

Box box_of(const Obstacle& obstacle, const Box& interior) {
    Box box;
    box.lo = {static_cast<float>(obstacle.x.lo), 0, static_cast<float>(obstacle.z.lo)};
    box.hi = {static_cast<float>(obstacle.x.hi), static_cast<float>(obstacle.height),
              static_cast<float>(obstacle.z.hi)};
    box.lo[1] = -Box::inf;  // obstacles stand on the bed
    for (std::size_t k = 0; k < 3; ++k) {
        box.lo[k] = box.lo[k] <= interior.lo[k] ? -Box::inf : box.lo[k];
        box.hi[k] = box.hi[k] >= interior.hi[k] ? Box::inf : box.hi[k];
    }
    return box;
}

// Adds the reflection across a plane of which R and the velocity, if water sticks to it, are given.
void reflect_velocities(Mirror& mirror, const PlaneMap& reflection, const std::optional<Vec3>& sticks) {
    mirror.reflection = product(reflection, mirror.reflection);
    ImageVelocity& image = mirror.viscous;
    if (!sticks) {
        image.map = product(reflection, image.map);
        image.shift = reflection(image.shift);
        return;
    }
    // u -> 2 U - u. In the corner of two such planes the image of the image moves like the particle.
    const bool twice = image.sticks;
    image.sticks = true;
    image.map = product({-1, 0, -1, -1}, image.map);
    for (std::size_t k = 0; k < 3; ++k) {
        image.shift[k] = twice ? 0 : 2 * (*sticks)[k] - image.shift[k];
    }
}

void add_plane(Mirror& mirror, std::size_t axis, float plane, const std::optional<Vec3>& sticks) {
    mirror.axis[axis] = true;
    mirror.plane[axis] = plane;
    PlaneMap reflection;
    (axis == 0 ? reflection.xx : axis == 1 ? reflection.yy : reflection.zz) = -1;
    reflect_velocities(mirror, reflection, sticks);
}

const float* along(const Places& x, std::size_t axis) {
    return axis == 0 ? x.x : axis == 1 ? x.y : x.z;
}

unsigned all_bits(std::size_t count) {
    return count < 32 ? (1U << count) - 1 : ~0U;
}

// Of the straight lines from `count` places x to y, those that pass through the box: a bit each.
unsigned lines_through(const Box& box, const Places& x, std::size_t count, const Vec3& y) {
    unsigned through = 0;
    // The part of the line x + t (y - x), 0 < t < 1, that lies between both faces of every axis.
    const auto cut = [](float lo, float hi, float from, float to, float& enter, float& leave) {
        const float way = to - from;
        const float to_lo = (lo - from) / way;
        const float to_hi = (hi - from) / way;
        const float first = to_hi < to_lo ? to_hi : to_lo, last = to_lo < to_hi ? to_hi : to_lo;
        const bool between = from > lo && from < hi;  // all the way, if there is none
        const float entered = enter < first ? first : enter, left = last < leave ? last : leave;
        enter = way == 0 ? enter : entered;
        leave = way == 0 ? (between ? leave : -1.0F) : left;
    };
#pragma omp simd reduction(| : through)
    for (unsigned l = 0; l < count; ++l) {
        float enter = 0, leave = 1;
        cut(box.lo[0], box.hi[0], x.x[l], y[0], enter, leave);
        cut(box.lo[1], box.hi[1], x.y[l], y[1], enter, leave);
        cut(box.lo[2], box.hi[2], x.z[l], y[2], enter, leave);
        through |= static_cast<unsigned>(enter < leave) << l;
    }
    return through;
}

}  // namespace

Solids::Solids(const Scene& scene)
    : interior_(interior_of(scene.channel)),
      bed_(bed_facets(scene.channel)),
      support_radius_(static_cast<float>(support_radius_of(scene.fluid))),
      contact_distance_(contact_fraction * static_cast<float>(scene.fluid.particle_spacing)) {
    for (const Obstacle& obstacle : scene.obstacles) {
        obstacles_.push_back(box_of(obstacle, interior_));
    }
    index_ = BoxIndex(obstacles_);
    for (const NoSlip& wall : scene.channel.no_slip) {
        const Vec3 velocity{static_cast<float>(wall.velocity[0]), static_cast<float>(wall.velocity[1]),
                            static_cast<float>(wall.velocity[2])};
        switch (wall.plane) {
            case Plane::bed:
                sticks_[1][0] = velocity;
                break;
            case Plane::top:
                sticks_[1][1] = velocity;
                break;
            case Plane::x_min:
                sticks_[0][0] = velocity;
                break;
            case Plane::x_max:
                sticks_[0][1] = velocity;
                break;
            case Plane::z_min:
                sticks_[2][0] = velocity;
                break;
            case Plane::z_max:
                sticks_[2][1] = velocity;
                break;
            case Plane::obstacles:
                obstacles_stick_ = velocity;
                break;
        }
    }
}

bool Solids::near(const Box& a, const Box& b) const {
    for (std::size_t k = 0; k < 3; ++k) {
        if (a.hi[k] <= b.lo[k] - support_radius_ || a.lo[k] >= b.hi[k] + support_radius_) {
            return false;
        }
    }
    return true;
}

void Solids::find_obstacles(const Box& box, BoxNumbers& found) const {
    if (obstacles_.empty()) {
        found.clear();
        return;
    }
    const Box reach = grown(box, search_radii * support_radius_);
    index_.find(reach, found);
    std::erase_if(found, [&](std::uint32_t o) {
        const Box& obstacle = obstacles_[o];
        for (std::size_t k = 0; k < 3; ++k) {
            if (obstacle.hi[k] < reach.lo[k] || obstacle.lo[k] > reach.hi[k]) return true;
        }
        return false;
    });
}

void Solids::mirrors_near(const Box& box, const BoxNumbers& obstacles, std::vector<Mirror>& mirrors) const {
    mirrors.clear();
    mirrors.push_back({});  // no reflection; each axis then adds its own to all that are there
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t before = mirrors.size();
        for (const bool upper : {false, true}) {
            const float plane = upper ? interior_.hi[k] : interior_.lo[k];
            if (box.lo[k] - support_radius_ < plane && plane < box.hi[k] + support_radius_) {
                for (std::size_t m = 0; m < before; ++m) {
                    Mirror mirror = mirrors[m];
                    add_plane(mirror, k, plane, sticks_[k][upper ? 1 : 0]);
                    mirrors.push_back(mirror);
                }
            }
        }
        if (k == 1) {
            add_facet_mirrors(box, before, mirrors);
        }
    }
    if (!obstacles.empty()) {
        add_obstacle_mirrors(box, obstacles, mirrors);
    }
    mirrors.erase(mirrors.begin());
}

void Solids::add_facet_mirrors(const Box& box, std::size_t before, std::vector<Mirror>& mirrors) const {
    const float middle_x = 0.5F * (box.lo[0] + box.hi[0]);
    const float middle_y = 0.5F * (box.lo[1] + box.hi[1]);
    for (std::size_t f = 0; f < bed_.size(); ++f) {
        const BedFacet& facet = bed_[f];
        const float reach = support_radius_ + 0.5F * (std::abs(facet.nx) * (box.hi[0] - box.lo[0]) +
                                                      std::abs(facet.ny) * (box.hi[1] - box.lo[1]));
        if (box.hi[0] <= facet.x_lo - support_radius_ || box.lo[0] >= facet.x_hi + support_radius_ ||
            std::abs(facet.distance(middle_x, middle_y)) >= reach) {
            continue;
        }
        for (std::size_t m = 0; m < before; ++m) {
            Mirror mirror = mirrors[m];
            if (facet.level()) {
                add_plane(mirror, 1, facet.py, sticks_[1][0]);
            } else if (mirror.axis[0]) {
                continue;  // the corner of an inclined bed and an end wall has no image of an image
            } else {
                mirror.inclined = true;
                mirror.nx = facet.nx, mirror.ny = facet.ny, mirror.px = facet.px, mirror.py = facet.py;
                reflect_velocities(
                    mirror, {1 - 2 * facet.nx * facet.nx, -2 * facet.nx * facet.ny, 1 - 2 * facet.ny * facet.ny, 1},
                    sticks_[1][0]);
            }
            mirror.facet = static_cast<int>(f);
            mirrors.push_back(mirror);
        }
    }
}

bool Solids::sees_in_facet(const Vec3& x, const Vec3& y, const Mirror& mirror) const {
    const BedFacet& facet = bed_[static_cast<std::size_t>(mirror.facet)];
    const float middle = 0.5F * (x[0] + y[0]);
    return middle >= facet.x_lo && middle < facet.x_hi && facet.distance(x[0], x[1]) + facet.distance(y[0], y[1]) > 0;
}

void Solids::add_obstacle_mirrors(const Box& box, const BoxNumbers& obstacles, std::vector<Mirror>& mirrors) const {
    const std::size_t walls = mirrors.size();
    for (const std::uint32_t o : obstacles) {
        const Box& obstacle = obstacles_[o];
        for (std::size_t k = 0; k < 3 && near(obstacle, box); ++k) {
            for (const bool upper : {false, true}) {
                if (upper ? box.hi[k] < obstacle.hi[k] : box.lo[k] > obstacle.lo[k]) {
                    continue;  // nobody is on this face's side
                }
                for (std::size_t m = 0; m < walls; ++m) {
                    Mirror mirror = mirrors[m];
                    if (!mirror.axis[k] && (k == 2 || !mirror.inclined)) {
                        add_plane(mirror, k, upper ? obstacle.hi[k] : obstacle.lo[k], obstacles_stick_);
                        mirror.obstacle = static_cast<int>(o);
                        mirror.obstacle_axis = k;
                        mirrors.push_back(mirror);
                    }
                }
            }
        }
    }
}

bool Solids::obstacle_near(const Box& box, const BoxNumbers& obstacles) const {
    return std::any_of(obstacles.begin(), obstacles.end(), [&](std::uint32_t o) { return near(obstacles_[o], box); });
}

unsigned Solids::visible(const Places& x, std::size_t count, const Box& box, const Vec3& y,
                         const BoxNumbers& obstacles) const {
    unsigned hidden = 0;
    for (const std::uint32_t o : obstacles) {
        const Box& obstacle = obstacles_[o];
        bool apart = false;  // along some axis both ends of all lines lie on the same side of the obstacle
        for (std::size_t k = 0; k < 3; ++k) {
            apart = apart || std::max(box.hi[k], y[k]) <= obstacle.lo[k] || std::min(box.lo[k], y[k]) >= obstacle.hi[k];
        }
        hidden |= apart ? 0U : lines_through(obstacle, x, count, y);
    }
    return ~hidden & all_bits(count);
}

unsigned Solids::sees_image(const Places& x, std::size_t count, const Vec3& y, const Mirror& mirror) const {
    const Box& box = obstacles_[static_cast<std::size_t>(mirror.obstacle)];
    const std::size_t k = mirror.obstacle_axis, m = (k + 1) % 3, n = (k + 2) % 3;
    const float plane = mirror.plane[k], side = plane == box.hi[k] ? 1.0F : -1.0F;
    const float to = side * (y[k] - plane);
    if (to < 0) return 0;
    const auto image = [&](std::size_t axis) { return mirror.axis[axis] ? 2 * mirror.plane[axis] - y[axis] : y[axis]; };
    const float ym = image(m), yn = image(n);
    const float m_lo = box.lo[m], m_hi = box.hi[m], n_lo = box.lo[n], n_hi = box.hi[n];
    const float *xk = along(x, k), *xm = along(x, m), *xn = along(x, n);
    unsigned seen = 0;
#pragma omp simd reduction(| : seen)
    for (unsigned l = 0; l < count; ++l) {
        const float from = side * (xk[l] - plane);
        // Both on the face's side.
        bool sees = from >= 0 && from + to > 0;
        const float part = from / (from + to);
        const float at_m = xm[l] + part * (ym - xm[l]), at_n = xn[l] + part * (yn - xn[l]);
        sees = sees && at_m > m_lo && at_m < m_hi && at_n > n_lo && at_n < n_hi;
        seen |= static_cast<unsigned>(sees) << l;
    }
    return seen;
}

}  // namespace wade::fluid
