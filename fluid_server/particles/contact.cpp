// What keeps particles out of solids where pressure does not.

#include <algorithm>
#include <cstddef>

#include "fluid_server/particles/solids.hpp"

namespace wade::fluid {

namespace {

// Moves a point in a box to its nearest face; true if it had to.
bool push_out_of(const Box& box, Vec3& x) {
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
    if (inside) x[axis] = target;
    return inside;
}

}  // namespace

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
    // In the order of their numbers; who is pushed out of one goes on from where it then is.
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
