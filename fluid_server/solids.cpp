#include "fluid_server/solids.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace wade::fluid {

namespace {

// A particle stands for a cube of side d; its centre may come as near to a face as this fraction of d. Pressure keeps
// a filled layer at about d/2, so that contact acts on thin sheets only.
constexpr float contact_fraction = 0.4F;

Box interior_of(const Channel& channel) {
    Box box;
    box.lo[1] = 0;
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
    for (std::size_t k = 0; k < 3; ++k) {
        box.lo[k] = box.lo[k] <= interior.lo[k] ? -Box::inf : box.lo[k];
        box.hi[k] = box.hi[k] >= interior.hi[k] ? Box::inf : box.hi[k];
    }
    return box;
}

}  // namespace

Solids::Solids(const Scene& scene)
    : interior_(interior_of(scene.channel)),
      support_radius_(static_cast<float>(2 * scene.fluid.particle_spacing)),
      contact_distance_(contact_fraction * static_cast<float>(scene.fluid.particle_spacing)) {
    for (const Obstacle& obstacle : scene.obstacles) {
        obstacles_.push_back(box_of(obstacle, interior_));
    }
}

bool Solids::near(const Box& box, const Vec3& x) const {
    for (std::size_t k = 0; k < 3; ++k) {
        if (x[k] <= box.lo[k] - support_radius_ || x[k] >= box.hi[k] + support_radius_) {
            return false;
        }
    }
    return true;
}

void Solids::mirrors_near(const Vec3& x, std::vector<Mirror>& mirrors) const {
    mirrors.clear();
    mirrors.push_back({});  // no reflection; each axis then adds its own to all that are there
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t before = mirrors.size();
        for (const float plane : {interior_.lo[k], interior_.hi[k]}) {
            if (std::abs(x[k] - plane) < support_radius_) {
                for (std::size_t m = 0; m < before; ++m) {
                    Mirror mirror = mirrors[m];
                    mirror.axis[k] = true;
                    mirror.plane[k] = plane;
                    mirrors.push_back(mirror);
                }
            }
        }
    }
    if (!obstacles_.empty()) {
        add_obstacle_mirrors(x, mirrors);
    }
    mirrors.erase(mirrors.begin());
}

void Solids::add_obstacle_mirrors(const Vec3& x, std::vector<Mirror>& mirrors) const {
    const std::size_t walls = mirrors.size();
    for (std::size_t o = 0; o < obstacles_.size(); ++o) {
        const Box& box = obstacles_[o];
        for (std::size_t k = 0; k < 3 && near(box, x); ++k) {
            const bool beyond = x[k] >= box.hi[k];
            if (!beyond && x[k] > box.lo[k]) {
                continue;  // this axis has no face that the particle can see
            }
            for (std::size_t m = 0; m < walls; ++m) {
                Mirror mirror = mirrors[m];
                if (!mirror.axis[k]) {
                    mirror.axis[k] = true;
                    mirror.plane[k] = beyond ? box.hi[k] : box.lo[k];
                    mirror.obstacle = static_cast<int>(o);
                    mirror.obstacle_axis = k;
                    mirrors.push_back(mirror);
                }
            }
        }
    }
}

bool Solids::obstacle_near(const Vec3& x) const {
    return std::any_of(obstacles_.begin(), obstacles_.end(), [&](const Box& box) { return near(box, x); });
}

bool Solids::visible(const Vec3& x, const Vec3& y) const {
    for (const Box& box : obstacles_) {
        // The part of the line x + t (y - x), 0 < t < 1, that lies between both faces of every axis.
        float enter = 0;
        float leave = 1;
        for (std::size_t k = 0; k < 3; ++k) {
            const float way = y[k] - x[k];
            if (way == 0) {
                leave = x[k] > box.lo[k] && x[k] < box.hi[k] ? leave : -1;
            } else {
                const float to_lo = (box.lo[k] - x[k]) / way;
                const float to_hi = (box.hi[k] - x[k]) / way;
                enter = std::max(enter, std::min(to_lo, to_hi));
                leave = std::min(leave, std::max(to_lo, to_hi));
            }
        }
        if (enter < leave) {
            return false;
        }
    }
    return true;
}

bool Solids::sees_image(const Vec3& x, const Vec3& y, const Mirror& mirror) const {
    const Box& box = obstacles_[static_cast<std::size_t>(mirror.obstacle)];
    const std::size_t k = mirror.obstacle_axis;
    const float side = mirror.plane[k] == box.hi[k] ? 1.0F : -1.0F;
    const float from = side * (x[k] - mirror.plane[k]);
    const float to = side * (y[k] - mirror.plane[k]);
    if (from < 0 || to < 0 || from + to <= 0) {
        return false;  // one of them is not on the face's side
    }
    for (std::size_t m = 0; m < 3; ++m) {
        if (m != k) {
            const float ym = mirror.axis[m] ? 2 * mirror.plane[m] - y[m] : y[m];
            const float crossing = x[m] + from / (from + to) * (ym - x[m]);
            if (crossing <= box.lo[m] || crossing >= box.hi[m]) {
                return false;
            }
        }
    }
    return true;
}

Vec3 Solids::apply_contact(const Vec3& x, float dt, Vec3& v) const {
    const Vec3 before = v;
    for (std::size_t k = 0; k < 3; ++k) {
        const float to_lo = interior_.lo[k] + contact_distance_ - x[k];  // negative while free
        const float to_hi = interior_.hi[k] - contact_distance_ - x[k];  // positive while free
        v[k] = std::max(v[k], std::min(to_lo, 0.0F) / dt);
        v[k] = std::min(v[k], std::max(to_hi, 0.0F) / dt);
    }
    for (const Box& box : obstacles_) {
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
    }
    return {before[0] - v[0], before[1] - v[1], before[2] - v[2]};
}

bool Solids::clamp(Vec3& x) const {
    bool moved = false;
    for (std::size_t k = 0; k < 3; ++k) {
        const float inside = std::max(interior_.lo[k], std::min(interior_.hi[k], x[k]));
        moved = moved || inside != x[k];
        x[k] = inside;
    }
    for (const Box& box : obstacles_) {
        std::size_t axis = 0;
        float depth = Box::inf;
        float target = 0;
        bool inside = true;
        for (std::size_t k = 0; k < 3; ++k) {
            inside = inside && x[k] > box.lo[k] && x[k] < box.hi[k];
            if (x[k] - box.lo[k] < depth) {
                depth = x[k] - box.lo[k], axis = k, target = box.lo[k];
            }
            if (box.hi[k] - x[k] < depth) {
                depth = box.hi[k] - x[k], axis = k, target = box.hi[k];
            }
        }
        if (inside) {
            x[axis] = target;
            moved = true;
        }
    }
    return moved;
}

}  // namespace wade::fluid
