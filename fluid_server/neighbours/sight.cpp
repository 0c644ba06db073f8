#include "fluid_server/neighbours/sight.hpp"

#include <array>
#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fluid_server/neighbours/sight.cpp"
#include <hwy/foreach_target.h>

#include "fluid_server/neighbours/sight-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace wade::fluid::HWY_NAMESPACE {

// Returns the lanes that see y in a facet of the bed: the point halfway to y must lie over the facet.
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

std::size_t FindSeenOver(const Watchers& watchers, const Sight& sight, float h, const Particles& p, std::size_t first,
                         std::size_t last, NeighbourBlock& block) {
    const Vec3V x = load(watchers.places);
    return keep(sight, h, p, first, last, block,
                [&](const Vec3& y, Seen near) HWY_ATTR { return hn::And(near, over(*sight.facet, x, y)); });
}

// share_of(x, y, near): how much of y each lane sees that is near.
template <typename ShareOf>
HWY_INLINE std::size_t keep_shares(const Watchers& watchers, const Sight& sight, float h, const Particles& p,
                                   std::size_t first, std::size_t last, NeighbourBlock& block, std::uint16_t*& shares,
                                   ShareOf&& share_of) {
    const Whole whole;
    const Vec3V x = load(watchers.places);
    return keep(sight, h, p, first, last, block, [&](const Vec3& y, Seen near) HWY_ATTR {
        const Seen over_facet = sight.facet == nullptr ? near : hn::And(near, over(*sight.facet, x, y));
        const auto units = hn::NearestInt(hn::Mul(share_of(x, y, near), all(whole_share)));
        const Seen seen = hn::And(over_facet, hn::RebindMask(lanes, hn::Gt(units, hn::Zero(whole))));
        put_together(units, bits_of(seen), shares);
        shares += std::popcount(bits_of(seen));
        return seen;
    });
}

std::size_t FindSharesSeen(const Watchers& watchers, const Sight& sight, float h, const Particles& p, std::size_t first,
                           std::size_t last, NeighbourBlock& block, std::uint16_t*& shares) {
    if (sight.obstacle != nullptr) {
        const Face face(*sight.obstacle, sight.mirror, load(watchers.places), watchers.delta);
        return keep_shares(watchers, sight, h, p, first, last, block, shares,
                           [&](const Vec3V&, const Vec3& y, Seen)
                               HWY_ATTR { return face.distance(y) < 0 ? hn::Zero(lanes) : face.share_of(y); });
    }
    return keep_shares(
        watchers, sight, h, p, first, last, block, shares, [&](const Vec3V& x, const Vec3& y, Seen near) HWY_ATTR {
            return seen_past_all(watchers.obstacles, watchers.box, x, sight.mirror.reflect(y), near, watchers.delta);
        });
}

std::size_t FindNearBox(const Box& box, float support_radius, const Particles& p, std::span<const Run> runs,
                        std::uint32_t* out) {
    const Numbers numbers;
    const auto first_numbers = hn::Iota(numbers, 0);
    const NearBox near_box(box, support_radius);
    std::size_t found = 0;
    for (const Run& run : runs) {
        // A particle of the run a lane.
        for (std::size_t m = run.begin; m < run.end; m += cluster_size) {
            const unsigned near = near_box(load(places(p), m)) & first_lanes(run.end - m);
            put_together(hn::Add(first_numbers, hn::Set(numbers, static_cast<std::uint32_t>(m))), near, out + found);
            found += static_cast<std::size_t>(std::popcount(near));
        }
    }
    return found;
}

std::size_t FindNearPlaces(const ClusterPositions& places, float support_radius, const Particles& p,
                           std::span<const std::uint32_t> candidates, std::uint32_t* out) {
    const V h2 = all(support_radius * support_radius);
    const Vec3V x = load(ConstVectorArrays{places.x.data(), places.y.data(), places.z.data()}, 0);
    std::size_t found = 0;
    for (const std::uint32_t j : candidates) {
        const Vec3V way = way_from(x, p, j);
        out[found] = j;
        found += hn::AllFalse(lanes, hn::Lt(dot(way, way), h2)) ? 0U : 1U;
    }
    return found;
}

}  // namespace wade::fluid::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace wade::fluid {

HWY_EXPORT(FindSeenOver);
HWY_EXPORT(FindSharesSeen);
HWY_EXPORT(FindNearBox);
HWY_EXPORT(FindNearPlaces);

std::size_t keep_seen_over_facet(const Watchers& watchers, const Sight& sight, float support_radius,
                                 const Particles& particles, std::size_t first, std::size_t last,
                                 NeighbourBlock& block) {
    return HWY_DYNAMIC_DISPATCH(FindSeenOver)(watchers, sight, support_radius, particles, first, last, block);
}

std::size_t keep_seen_in_part(const Watchers& watchers, const Sight& sight, float support_radius,
                              const Particles& particles, std::size_t first, std::size_t last, NeighbourBlock& block,
                              std::uint16_t*& shares) {
    return HWY_DYNAMIC_DISPATCH(FindSharesSeen)(watchers, sight, support_radius, particles, first, last, block, shares);
}

std::size_t find_near_box(const Box& box, float support_radius, const Particles& p, std::span<const Run> runs,
                          std::uint32_t* out) {
    return HWY_DYNAMIC_DISPATCH(FindNearBox)(box, support_radius, p, runs, out);
}

std::size_t find_near_particles(const ClusterPositions& places, float support_radius, const Particles& p,
                                std::span<const std::uint32_t> candidates, std::uint32_t* out) {
    return HWY_DYNAMIC_DISPATCH(FindNearPlaces)(places, support_radius, p, candidates, out);
}

}  // namespace wade::fluid
#endif
