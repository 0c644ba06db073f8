#include "fluid_server/neighbours/sight.hpp"

#include <algorithm>
#include <array>
#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fluid_server/neighbours/sight.cpp"
#include <hwy/foreach_target.h>

#include "fluid_server/neighbours/vectors-inl.hpp"

// No product is fused with a sum here: what one side of a face sees of the other does not depend on the instruction set.
HWY_BEFORE_NAMESPACE();
namespace wade::fluid::HWY_NAMESPACE {

using Seen = hn::Mask<Lanes>;

HWY_INLINE Vec3V load(const ClusterPlaces& places) {
    return load(ConstVectorArrays{places.x.data(), places.y.data(), places.z.data()}, 0);
}
HWY_INLINE V along(const Vec3V& x, std::size_t axis) {
    return axis == 0 ? x.x : axis == 1 ? x.y : x.z;
}

// The part of the line x + t (y - x), 0 < t < 1, that lies between both faces of every axis.
struct Cut {
    V enter, leave;

    HWY_INLINE void by_faces(float lo, float hi, V x, float y) {
        const V way = hn::Sub(all(y), x);
        const V to_lo = hn::Div(hn::Sub(all(lo), x), way), to_hi = hn::Div(hn::Sub(all(hi), x), way);
        // Without a way along this axis it lies between them everywhere or nowhere.
        const Seen none = hn::Eq(way, hn::Zero(lanes));
        const Seen between = hn::And(hn::Gt(x, all(lo)), hn::Lt(x, all(hi)));
        const V left = hn::Min(leave, hn::Max(to_lo, to_hi));
        enter = hn::IfThenElse(none, enter, hn::Max(enter, hn::Min(to_lo, to_hi)));
        leave = hn::IfThenElse(none, hn::IfThenElse(between, leave, all(-1)), left);
    }
};

// Whose straight line from x to y passes through an obstacle; box: round the places x. An axis along which all lines end on one
// side of it decides alone, and one along which all lie between its faces cuts none.
HWY_INLINE Seen through(const Box& obstacle, const Box& box, const Vec3V& x, const Vec3& y) {
    std::array<bool, 3> between{};
    for (std::size_t k = 0; k < 3; ++k) {
        const float lo = std::min(box.lo[k], y[k]), hi = std::max(box.hi[k], y[k]);
        if (hi <= obstacle.lo[k] || lo >= obstacle.hi[k]) return hn::MaskFromVec(hn::Zero(lanes));
        between[k] = lo > obstacle.lo[k] && hi < obstacle.hi[k];
    }
    Cut cut{hn::Zero(lanes), all(1)};
    if (!between[0]) cut.by_faces(obstacle.lo[0], obstacle.hi[0], x.x, y[0]);
    if (!between[1]) cut.by_faces(obstacle.lo[1], obstacle.hi[1], x.y, y[1]);
    if (!between[2]) cut.by_faces(obstacle.lo[2], obstacle.hi[2], x.z, y[2]);
    return hn::Lt(cut.enter, cut.leave);
}

// The face of an obstacle as a mirror: who sees a particle at y in it.
class Face {
 public:
    HWY_INLINE Face(const Box& box, const Mirror& mirror, const Vec3V& x)
        : mirror_(mirror),
          k_(mirror.obstacle_axis),
          m_((k_ + 1) % 3),
          n_((k_ + 2) % 3),
          side_(mirror.plane[k_] == box.hi[k_] ? 1.0F : -1.0F),
          from_(hn::Mul(all(side_), hn::Sub(along(x, k_), all(mirror.plane[k_])))),
          xm_(along(x, m_)),
          xn_(along(x, n_)),
          m_lo_(all(box.lo[m_])),
          m_hi_(all(box.hi[m_])),
          n_lo_(all(box.lo[n_])),
          n_hi_(all(box.hi[n_])) {}

    // How far y is from the face, m; not on its side if negative.
    [[nodiscard]] HWY_INLINE float distance(const Vec3& y) const { return side_ * (y[k_] - mirror_.plane[k_]); }

    [[nodiscard]] HWY_INLINE Seen sees(const Vec3& y) const {
        const V way = hn::Add(from_, all(distance(y)));
        const V part = hn::Div(from_, way);
        const V m = hn::Add(xm_, hn::Mul(part, hn::Sub(all(image(y, m_)), xm_)));
        const V n = hn::Add(xn_, hn::Mul(part, hn::Sub(all(image(y, n_)), xn_)));
        const Seen on_side = hn::And(hn::Ge(from_, hn::Zero(lanes)), hn::Gt(way, hn::Zero(lanes)));
        const Seen in_m = hn::And(hn::Gt(m, m_lo_), hn::Lt(m, m_hi_));
        return hn::And(on_side, hn::And(in_m, hn::And(hn::Gt(n, n_lo_), hn::Lt(n, n_hi_))));
    }

 private:
    [[nodiscard]] HWY_INLINE float image(const Vec3& y, std::size_t axis) const {
        return mirror_.axis[axis] ? 2 * mirror_.plane[axis] - y[axis] : y[axis];
    }

    const Mirror& mirror_;
    std::size_t k_, m_, n_;
    float side_;
    V from_, xm_, xn_, m_lo_, m_hi_, n_lo_, n_hi_;
};

// Who sees y in a facet of the bed: over which the point halfway between them lies.
HWY_INLINE Seen over(const BedFacet& facet, const Vec3V& x, const Vec3& y) {
    const V middle = hn::Mul(all(0.5F), hn::Add(x.x, all(y[0])));
    const V above = hn::Add(hn::Mul(all(facet.nx), hn::Sub(x.x, all(facet.px))),
                            hn::Mul(all(facet.ny), hn::Sub(x.y, all(facet.py))));
    const V both = hn::Add(above, all(facet.distance(y[0], y[1])));
    return hn::And(hn::Gt(both, hn::Zero(lanes)),
                   hn::And(hn::Ge(middle, all(facet.x_lo)), hn::Lt(middle, all(facet.x_hi))));
}

// Calls sees(y, near) for each entry, near the lanes that are near enough; it returns which of them see y.
template <typename Sees>
HWY_INLINE std::size_t keep(const Sight& sight, float support_radius, const Particles& p, std::size_t first,
                            std::size_t last, NeighbourBlock& block, Sees&& sees) {
    LaneMask* const masks = lane_masks(block);
    std::uint32_t* const list = block.j.data();
    const Vec3V image = load(sight.image);
    const V h2 = all(support_radius * support_radius);
    std::size_t kept = first;
    for (std::size_t k = first; k < last; ++k) {
        const std::uint32_t j = list[k];
        const Vec3V way = way_from(image, p, j);
        const V r2 = hn::Add(hn::Add(hn::Mul(way.x, way.x), hn::Mul(way.y, way.y)), hn::Mul(way.z, way.z));
        const Vec3& period = sight.period;
        const unsigned seen =
            bits_of(sees({p.x[j] + period[0], p.y[j] + period[1], p.z[j] + period[2]}, hn::Lt(r2, h2)));
        list[kept] = j;
        masks[kept] = static_cast<LaneMask>(seen);
        kept += seen != 0 ? 1U : 0U;
    }
    return kept;
}

std::size_t FindSeen(const Watchers& watchers, const Sight& sight, float h, const Particles& p, std::size_t first,
                     std::size_t last, NeighbourBlock& block) {
    const Vec3V x = load(watchers.places);
    const auto over_facet = [&](const Vec3& y, Seen near) HWY_ATTR {
        return sight.facet == nullptr ? near : hn::And(near, over(*sight.facet, x, y));
    };
    if (watchers.obstacles.empty()) return keep(sight, h, p, first, last, block, over_facet);
    if (sight.obstacle != nullptr) {
        const Face face(*sight.obstacle, sight.mirror, x);
        return keep(sight, h, p, first, last, block, [&](const Vec3& y, Seen near) HWY_ATTR {
            return face.distance(y) < 0 ? hn::MaskFromVec(hn::Zero(lanes)) : hn::And(over_facet(y, near), face.sees(y));
        });
    }
    return keep(sight, h, p, first, last, block, [&](const Vec3& y, Seen near) HWY_ATTR {
        Seen seen = over_facet(y, near);
        const Vec3 at = sight.mirror.reflect(y);
        for (const Box& obstacle : watchers.obstacles) {
            seen = hn::AndNot(through(obstacle, watchers.box, x, at), seen);
        }
        return seen;
    });
}

std::size_t FindNearBoxAmong(const Box& box, float support_radius, const NearParticlesOfCluster& near,
                             std::uint32_t* out) {
    const Numbers numbers;
    const V h2 = all(support_radius * support_radius);
    const Vec3V lo{all(box.lo[0]), all(box.lo[1]), all(box.lo[2])}, hi{all(box.hi[0]), all(box.hi[1]), all(box.hi[2])};
    const auto gap = [](V at, V least, V most)
                         HWY_ATTR { return hn::Max(hn::Max(hn::Sub(least, at), hn::Sub(at, most)), hn::Zero(lanes)); };
    std::size_t found = 0;
    for (std::size_t m = 0; m < near.size; m += cluster_size) {
        const Vec3V x = load(ConstVectorArrays{near.x.data(), near.y.data(), near.z.data()}, m);
        const Vec3V way{gap(x.x, lo.x, hi.x), gap(x.y, lo.y, hi.y), gap(x.z, lo.z, hi.z)};
        const std::size_t left = near.size - m;
        const unsigned in_use = left < cluster_size ? (1U << left) - 1 : ~0U;
        const unsigned here = bits_of(hn::Lt(dot(way, way), h2)) & in_use;
        put_together(hn::LoadU(numbers, near.j.data() + m), here, out + found);
        found += static_cast<std::size_t>(std::popcount(here));
    }
    return found;
}

}  // namespace wade::fluid::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace wade::fluid {

HWY_EXPORT(FindSeen);
HWY_EXPORT(FindNearBoxAmong);

std::size_t keep_seen(const Watchers& watchers, const Sight& sight, float support_radius, const Particles& particles,
                      std::size_t first, std::size_t last, NeighbourBlock& block) {
    return HWY_DYNAMIC_DISPATCH(FindSeen)(watchers, sight, support_radius, particles, first, last, block);
}

std::size_t find_near_box_among(const Box& box, float support_radius, const NearParticlesOfCluster& particles,
                                std::uint32_t* out) {
    return HWY_DYNAMIC_DISPATCH(FindNearBoxAmong)(box, support_radius, particles, out);
}

void NearParticlesOfCluster::assign(std::span<const std::uint32_t> numbers, const Particles& particles) {
    size = numbers.size();
    if (j.size() < size + largest_cluster) {
        j.resize(size + size / 4 + largest_cluster);
        x.resize(j.size()), y.resize(j.size()), z.resize(j.size());
    }
    for (std::size_t k = 0; k < size; ++k) {
        j[k] = numbers[k];
        x[k] = particles.x[numbers[k]], y[k] = particles.y[numbers[k]], z[k] = particles.z[numbers[k]];
    }
}

}  // namespace wade::fluid
#endif
