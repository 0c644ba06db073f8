#include "fluid_server/particles/solids.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/scene_capacity.hpp"

namespace wade::fluid {

namespace {

// Obstacles are looked for within so many support radii and what sight fades over: a sixteenth more than where they have a say,
// which is far more than what rounding moves.
constexpr float search_radii = 1.0625F;

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

// How far the bed falls below the plane of each facet within the support radius of it, m. A particle seen in the facet may be as far
// below its plane, and the one that sees it as much farther above than the support radius.
std::vector<float> falls_of(const std::vector<BedFacet>& bed, float support_radius) {
    std::vector<float> falls;
    for (const BedFacet& facet : bed) {
        const float from = facet.x_lo - support_radius, to = facet.x_hi + support_radius;
        float fall = 0;
        const auto look_at = [&](float x) {
            if (std::isfinite(x)) fall = std::max(fall, -facet.distance(x, bed_height(bed, x)));
        };
        look_at(from), look_at(to);
        for (const BedFacet& other : bed) look_at(std::clamp(other.x_lo, from, to));
        falls.push_back(fall);
    }
    return falls;
}

// Adds the reflection across a plane. reflection: its R; sticks: its velocity, if the no-slip condition holds there.
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

// Moves a point in a box to its nearest face; true if it had to.
bool push_out_of(const Box& box, Vec3& x) {
    if (!is_inside(box, x)) return false;
    std::size_t axis = 0;
    float depth = Box::inf;
    float target = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        if (x[k] - box.lo[k] < depth) {
            depth = x[k] - box.lo[k], axis = k, target = box.lo[k];
        }
        if (box.hi[k] - x[k] < depth) {
            depth = box.hi[k] - x[k], axis = k, target = box.hi[k];
        }
    }
    x[axis] = target;
    return true;
}

}  // namespace

Solids::Solids(const Scene& scene)
    : interior_(interior_of(scene.channel)),
      bed_(bed_facets(scene.channel)),
      falls_(falls_of(bed_, static_cast<float>(support_radius_of(scene.fluid)))),
      support_radius_(static_cast<float>(support_radius_of(scene.fluid))),
      contact_distance_(contact_fraction * static_cast<float>(scene.fluid->particle_spacing)),
      sight_delta_(sight_fraction * static_cast<float>(scene.fluid->particle_spacing)) {
    for (const Obstacle& obstacle : scene.obstacles) {
        obstacles_.push_back(box_of(obstacle, interior_));
    }
    index_ = BoxIndex(obstacles_);
    for (const NoSlip& wall : scene.channel->no_slip) {
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
    const float reach = support_radius_ + sight_delta_;
    for (std::size_t k = 0; k < 3; ++k) {
        if (a.hi[k] <= b.lo[k] - reach || a.lo[k] >= b.hi[k] + reach) {
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
    const Box reach = grown(box, search_radii * support_radius_ + sight_delta_);
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
        const float half =
            0.5F * (std::abs(facet.nx) * (box.hi[0] - box.lo[0]) + std::abs(facet.ny) * (box.hi[1] - box.lo[1]));
        const float reach = support_radius_ + falls_[f] + half;
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

void Solids::add_obstacle_mirrors(const Box& box, const BoxNumbers& obstacles, std::vector<Mirror>& mirrors) const {
    const std::size_t walls = mirrors.size();
    for (const std::uint32_t o : obstacles) {
        const Box& obstacle = obstacles_[o];
        for (std::size_t k = 0; k < 3 && near(obstacle, box); ++k) {
            for (const bool upper : {false, true}) {
                if (upper ? box.hi[k] < obstacle.hi[k] : box.lo[k] > obstacle.lo[k]) {
                    continue;  // no particle is on this face's side
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

void Solids::apply_border_contact(const Places& x, std::size_t count, float dt, BlockVelocities& v) const {
    const float rate = 1 / dt;
    const auto keep_between = [&](std::size_t axis, const float* at, float* u) {
        const float lo = interior_.lo[axis] + contact_distance_;
        const float hi = interior_.hi[axis] - contact_distance_;
        if (lo == -Box::inf && hi == Box::inf) {
            return;
        }
#pragma omp simd
        for (std::size_t i = 0; i < count; ++i) {
            const float slowest = std::min(lo - at[i], 0.0F) * rate;  // negative while free
            const float fastest = std::max(hi - at[i], 0.0F) * rate;
            u[i] = std::min(std::max(u[i], slowest), fastest);
        }
    };
    keep_between(0, x.x, v.x.data());
    keep_between(1, x.y, v.y.data());
    keep_between(2, x.z, v.z.data());
    for (std::size_t i = 0; i < count && !bed_.empty(); ++i) {
        // The facet where the particle is, and the one where it goes.
        for (const float place : {x.x[i], x.x[i] + dt * v.x[i]}) {
            const BedFacet& facet = facet_at(bed_, place);
            const float to_bed = contact_distance_ - facet.distance(x.x[i], x.y[i]);
            const float approach = facet.nx * v.x[i] + facet.ny * v.y[i] - std::min(to_bed, 0.0F) * rate;
            if (approach < 0) {
                v.x[i] -= approach * facet.nx;
                v.y[i] -= approach * facet.ny;
            }
        }
    }
}

Box Solids::way_of(const Places& x, std::size_t begin, std::size_t end, float dt, const BlockVelocities& v) const {
    Box way{{Box::inf, Box::inf, Box::inf}, {-Box::inf, -Box::inf, -Box::inf}};
    const auto grow = [&](std::size_t axis, const float* at, const float* u) {
        float lo = Box::inf, hi = -Box::inf;
#pragma omp simd reduction(min : lo) reduction(max : hi)
        for (std::size_t i = begin; i < end; ++i) {
            const float next = at[i] + dt * u[i];
            lo = std::min(lo, std::min(at[i], next));
            hi = std::max(hi, std::max(at[i], next));
        }
        way.lo[axis] = lo, way.hi[axis] = hi;
    };
    grow(0, x.x, v.x.data()), grow(1, x.y, v.y.data()), grow(2, x.z, v.z.data());
    return way;
}

const BoxNumbers& Solids::obstacles_on(const Box& way) const {
    thread_local BoxNumbers found;
    index_.find(grown(way, 2 * contact_distance_), found);
    return found;
}

bool Solids::may_enter(const Box& way, const Box& obstacle) const {
    for (std::size_t k = 0; k < 3; ++k) {
        if (way.hi[k] <= obstacle.lo[k] - contact_distance_ || way.lo[k] >= obstacle.hi[k] + contact_distance_) {
            return false;
        }
    }
    return true;
}

std::array<bool, Solids::contact_group> Solids::who_enters(const Box& obstacle, const Places& x, std::size_t begin,
                                                           std::size_t end, float dt, const BlockVelocities& v) const {
    std::array<int, contact_group> enters{};
    std::fill_n(enters.begin(), end - begin, 1);
    const auto stay_between = [&](std::size_t axis, const float* at, const float* u) {
        const float lo = obstacle.lo[axis] - contact_distance_, hi = obstacle.hi[axis] + contact_distance_;
#pragma omp simd
        for (std::size_t l = 0; l < end - begin; ++l) {
            const float next = at[begin + l] + dt * u[begin + l];
            enters[l] &= static_cast<int>(next > lo) & static_cast<int>(next < hi);
        }
    };
    stay_between(0, x.x, v.x.data());
    stay_between(1, x.y, v.y.data());
    stay_between(2, x.z, v.z.data());
    std::array<bool, contact_group> who{};
    for (std::size_t l = 0; l < contact_group; ++l) who[l] = enters[l] != 0;
    return who;
}

bool Solids::apply_obstacle_contact(const Box& box, const Vec3& x, float dt, Vec3& v) const {
    // The axis along which the particle is farthest outside of the box decides which face it meets.
    std::size_t axis = 0;
    float gap = -Box::inf;
    float side = 0;
    bool would_enter = true;
    for (std::size_t k = 0; k < 3; ++k) {
        const float lo = box.lo[k] - contact_distance_;
        const float hi = box.hi[k] + contact_distance_;
        const float next = x[k] + dt * v[k];
        would_enter = would_enter && next > lo && next < hi;
        const float below = lo - x[k];
        const float above = x[k] - hi;
        const float outside = std::max(below, above);
        if (outside > gap) {
            gap = outside;
            axis = k;
            side = below > above ? -1.0F : 1.0F;
        }
    }
    if (would_enter) {
        const float room = std::max(gap, 0.0F) / dt;
        v[axis] = side < 0 ? std::min(v[axis], room) : std::max(v[axis], -room);
    }
    return would_enter;
}

bool Solids::push_out(Vec3& x) const {
    bool moved = false;
    for (std::size_t k = 0; k < 3; ++k) {
        const float inside = std::max(interior_.lo[k], std::min(interior_.hi[k], x[k]));
        moved = moved || inside != x[k];
        x[k] = inside;
    }
    if (!bed_.empty() && x[1] < bed_height(bed_, x[0])) {
        x[1] = bed_height(bed_, x[0]);
        moved = true;
    }
    // In the order of their numbers; each obstacle starts from the position that the previous one left.
    std::span<const std::uint32_t> here = index_.at(x[0], x[2]);
    for (std::size_t n = 0; n < here.size();) {
        const std::uint32_t o = here[n++];
        if (!push_out_of(obstacles_[o], x)) continue;
        moved = true;
        here = index_.at(x[0], x[2]);
        n = static_cast<std::size_t>(std::upper_bound(here.begin(), here.end(), o) - here.begin());
    }
    return moved;
}

}  // namespace wade::fluid
