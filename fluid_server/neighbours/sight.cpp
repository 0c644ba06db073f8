#include "fluid_server/neighbours/sight.hpp"

#include <algorithm>
#include <array>
#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fluid_server/neighbours/sight.cpp"
#include <hwy/foreach_target.h>

#include "fluid_server/neighbours/vectors-inl.hpp"

// No product is fused with a sum here: what one side of a face sees of the other does not depend on the instruction set.
//
// Soft sight. If sight ended sharply at an edge of a box, a particle that moves past it would come and go as a whole, here and as
// an image, and pressure would follow in jumps: water round a house never came to rest. So a line that passes an edge at a
// distance below delta counts in part. Let e be how far it stays away from the box, negative if it passes through it. Then
//
//         share = clamp(1/2 + e / (2 delta), 0, 1)      of a particle at the end of the line,
//         share = clamp(1/2 - e / (2 delta), 0, 1)      of an image there, seen in the face that the line enters.
//
// Both ask the same line about the same edge, so that the two add up to one: every place round a particle is still filled once, but
// for under one in a hundred, near the upper corners of a box, where three edges have a say.
// And both are the same from either end: e is the distance of a corner c from the line through x and y in the plane across the
// edge, (c - x) x (c - y) / |x - y|, the images' is reckoned from the point where line and face meet, and either changes nothing
// but its sign if x and y change places. So forces stay opposite. How a share changes as particles move is left out of the
// divergence: it is constant within a step.
//
// In three dimensions e is the largest distance by which one of six directions parts line and box: the three axes, and those
// across the line and one of them, which are what the edges ask for (separating axes, Gottschalk et al. 1996, SIGGRAPH, 171).
// Contact (solids.hpp) keeps all centres 0.4 spacings away from every face, delta is 0.3 of them: where a face is flat, nobody
// counts in part.
HWY_BEFORE_NAMESPACE();
namespace wade::fluid::HWY_NAMESPACE {

using Seen = hn::Mask<Lanes>;

HWY_INLINE Vec3V load(const ClusterPlaces& places) {
    return load(ConstVectorArrays{places.x.data(), places.y.data(), places.z.data()}, 0);
}
HWY_INLINE V along(const Vec3V& x, std::size_t axis) {
    return axis == 0 ? x.x : axis == 1 ? x.y : x.z;
}

// How much is seen past an edge at a distance, m; delta: see above.
HWY_INLINE V share_past(V distance, float delta) {
    const V share = hn::Add(all(0.5F), hn::Mul(distance, all(0.5F / delta)));
    return hn::Min(hn::Max(share, hn::Zero(lanes)), all(1));
}

// Along an axis the ways from both ends of a line to both faces of a box, and that from end to end: reckoned by itself, so that it
// does not depend on where a face far away was cut off.
struct ToFaces {
    V x_lo, x_hi, y_lo, y_hi, x_y;
};

// How far the four edges along an axis keep a line from their box, m; m and n: from its ends x and y along the other two axes.
HWY_INLINE V past_edges(const ToFaces& m, const ToFaces& n) {
    const auto side = [](V xm, V ym, V xn, V yn) HWY_ATTR { return hn::Sub(hn::Mul(xm, yn), hn::Mul(xn, ym)); };
    const V a = side(m.x_lo, m.y_lo, n.x_lo, n.y_lo), b = side(m.x_lo, m.y_lo, n.x_hi, n.y_hi);
    const V c = side(m.x_hi, m.y_hi, n.x_lo, n.y_lo), d = side(m.x_hi, m.y_hi, n.x_hi, n.y_hi);
    const V least = hn::Min(hn::Min(a, b), hn::Min(c, d)), most = hn::Max(hn::Max(a, b), hn::Max(c, d));
    const V length2 = hn::Add(hn::Mul(m.x_y, m.x_y), hn::Mul(n.x_y, n.x_y));
    const V distance = hn::Div(hn::Max(least, hn::Neg(most)), hn::Sqrt(length2));
    // A line along the axis has no side here.
    return hn::IfThenElse(hn::Gt(length2, hn::Zero(lanes)), distance, all(-Box::inf));
}

// How much of y is seen past an obstacle; box: round the places x. An axis along which all lines end on one side of it, delta
// away, decides alone, and one along which all stay more than delta away from both faces has no say. near: the lanes that count.
HWY_INLINE V seen_past(const Box& obstacle, const Box& box, const Vec3V& x, const Vec3& y, Seen near, float delta) {
    const float far = 8 * delta;  // a face farther away than that has no say, be it at infinity
    std::array<bool, 3> between{};
    Vec3 lo{}, hi{};
    for (std::size_t k = 0; k < 3; ++k) {
        const float least = std::min(box.lo[k], y[k]), most = std::max(box.hi[k], y[k]);
        if (most <= obstacle.lo[k] - delta || least >= obstacle.hi[k] + delta) return all(1);
        between[k] = least > obstacle.lo[k] + delta && most < obstacle.hi[k] - delta;
        lo[k] = std::max(obstacle.lo[k], least - far), hi[k] = std::min(obstacle.hi[k], most + far);
    }
    const auto faces = [&](std::size_t k) HWY_ATTR {
        const V from = along(x, k);
        return ToFaces{hn::Sub(all(lo[k]), from), hn::Sub(all(hi[k]), from), all(lo[k] - y[k]), all(hi[k] - y[k]),
                       hn::Sub(all(y[k]), from)};
    };
    const std::array<ToFaces, 3> to{faces(0), faces(1), faces(2)};
    V distance = all(-Box::inf);
    for (std::size_t k = 0; k < 3; ++k) {
        if (between[k]) continue;
        const V below = hn::Min(to[k].x_lo, to[k].y_lo), above = hn::Neg(hn::Max(to[k].x_hi, to[k].y_hi));
        distance = hn::Max(distance, hn::Max(below, above));
    }
    // Most lines of a cluster at a corner end on one side, each of its own.
    if (hn::AllFalse(lanes, hn::And(near, hn::Lt(distance, all(delta))))) return all(1);
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t m = (k + 1) % 3, n = (k + 2) % 3;
        if (between[m] || between[n]) continue;
        distance = hn::Max(distance, past_edges(to[m], to[n]));
    }
    return share_past(distance, delta);
}

// The face of an obstacle as a mirror: how much of a particle at y is seen in it.
class Face {
 public:
    HWY_INLINE Face(const Box& box, const Mirror& mirror, const Vec3V& x, float delta)
        : box_(box),
          mirror_(mirror),
          delta_(delta),
          k_(mirror.obstacle_axis),
          m_((k_ + 1) % 3),
          n_((k_ + 2) % 3),
          side_(mirror.plane[k_] == box.hi[k_] ? 1.0F : -1.0F),
          from_(hn::Mul(all(side_), hn::Sub(along(x, k_), all(mirror.plane[k_])))),
          xm_(along(x, m_)),
          xn_(along(x, n_)) {}

    // How far y is from the face, m; not on its side if negative.
    [[nodiscard]] HWY_INLINE float distance(const Vec3& y) const { return side_ * (y[k_] - mirror_.plane[k_]); }

    [[nodiscard]] HWY_INLINE V share_of(const Vec3& y) const {
        const V to = all(distance(y));
        const V way = hn::Add(from_, to);
        const Seen on_side = hn::And(hn::Ge(from_, hn::Zero(lanes)), hn::Gt(way, hn::Zero(lanes)));
        const V within = hn::Min(within_edges(m_, xm_, y, to, way), within_edges(n_, xn_, y, to, way));
        return hn::IfThenElseZero(on_side, share_past(within, delta_));
    }

 private:
    // How far the line to the image passes within both edges of the face, m, seen along these; negative if outside. A line that
    // ends before it reaches beyond an edge stays outside by as much.
    [[nodiscard]] HWY_INLINE V within_edges(std::size_t m, V x, const Vec3& particle, V to, V way) const {
        const float lo = box_.lo[m], hi = box_.hi[m];
        if (lo == -Box::inf && hi == Box::inf) return all(Box::inf);
        const V y = all(mirror_.axis[m] ? 2 * mirror_.plane[m] - particle[m] : particle[m]);
        const V crossing = hn::Div(hn::Add(hn::Mul(x, to), hn::Mul(y, from_)), way);
        const V beside = hn::Sub(y, x);
        const V cosine = hn::Div(way, hn::Sqrt(hn::Add(hn::Mul(way, way), hn::Mul(beside, beside))));
        const V line = hn::Mul(hn::Min(hn::Sub(crossing, all(lo)), hn::Sub(all(hi), crossing)), cosine);
        const V ends = hn::Min(hn::Sub(hn::Max(x, y), all(lo)), hn::Sub(all(hi), hn::Min(x, y)));
        return hn::Min(line, ends);
    }

    const Box& box_;
    const Mirror& mirror_;
    float delta_;
    std::size_t k_, m_, n_;
    float side_;
    V from_, xm_, xn_;
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
    return keep_shares(watchers, sight, h, p, first, last, block, shares,
                       [&](const Vec3V& x, const Vec3& y, Seen near) HWY_ATTR {
                           const Vec3 at = sight.mirror.reflect(y);
                           V share = all(1);
                           for (const Box& obstacle : watchers.obstacles) {
                               share = hn::Min(share, seen_past(obstacle, watchers.box, x, at, near, watchers.delta));
                           }
                           return share;
                       });
}

// The bits of the first n lanes, of all if there are fewer.
HWY_INLINE unsigned first_lanes(std::size_t n) {
    return n < cluster_size ? (1U << n) - 1 : ~0U;
}

std::size_t FindNearBox(const Box& box, float support_radius, const Particles& p, std::span<const Run> runs,
                        std::uint32_t* out) {
    const Numbers numbers;
    const auto first_numbers = hn::Iota(numbers, 0);
    const V h2 = all(support_radius * support_radius);
    const Vec3V lo{all(box.lo[0]), all(box.lo[1]), all(box.lo[2])}, hi{all(box.hi[0]), all(box.hi[1]), all(box.hi[2])};
    const auto gap = [](V at, V least, V most) {
        return hn::Max(hn::Max(hn::Sub(least, at), hn::Sub(at, most)), hn::Zero(lanes));
    };
    std::size_t found = 0;
    for (const Run& run : runs) {
        // A particle of the run a lane.
        for (std::size_t m = run.begin; m < run.end; m += cluster_size) {
            const Vec3V x = load(places(p), m);
            const Vec3V way{gap(x.x, lo.x, hi.x), gap(x.y, lo.y, hi.y), gap(x.z, lo.z, hi.z)};
            const unsigned of_run = first_lanes(run.end - m);
            const unsigned near = bits_of(hn::Lt(dot(way, way), h2)) & of_run;
            put_together(hn::Add(first_numbers, hn::Set(numbers, static_cast<std::uint32_t>(m))), near, out + found);
            found += static_cast<std::size_t>(std::popcount(near));
        }
    }
    return found;
}

std::size_t FindNearPlaces(const ClusterPlaces& places, float support_radius, const Particles& p,
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

HWY_EXPORT(FindSeenOver);
HWY_EXPORT(FindSharesSeen);
HWY_EXPORT(FindNearBox);
HWY_EXPORT(FindNearBoxAmong);
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

std::size_t find_near_places(const ClusterPlaces& places, float support_radius, const Particles& p,
                             std::span<const std::uint32_t> candidates, std::uint32_t* out) {
    return HWY_DYNAMIC_DISPATCH(FindNearPlaces)(places, support_radius, p, candidates, out);
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
