#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "configs/scene/channel.hpp"
#include "fluid_server/neighbours/sight.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fluid_server/neighbours/seen_near.cpp"
#include <hwy/foreach_target.h>

#include "fluid_server/neighbours/cluster_positions.hpp"
#include "fluid_server/neighbours/sight-inl.hpp"

// What a cluster among boxes sees of the particles near it: the same as if each line were asked (sight.cpp), but few are. Most
// pairs see one another past a box as both lie beyond the same side of it, and nothing in a face as both lie beyond the same end of it;
// vectors of near particles, one a lane, sort these out. The bed shows a face what it showed without the bed.

HWY_BEFORE_NAMESPACE();
namespace wade::fluid::HWY_NAMESPACE {

// Which of the places of a cluster lie beyond each side of an obstacle, delta away or more. Two that lie beyond the same side see one
// another past it, and neither sees the other in a face next to that side: no line has to be asked.
class Sides {
 public:
    HWY_INLINE Sides(const Box& obstacle, const Vec3V& x, float delta) : obstacle_(obstacle), delta_(delta) {
        for (std::size_t k = 0; k < 3; ++k) {
            below_[k] = bits_of(hn::Ge(hn::Sub(all(obstacle.lo[k]), along(x, k)), all(delta)));
            above_[k] = bits_of(hn::Ge(hn::Sub(along(x, k), all(obstacle.hi[k])), all(delta)));
        }
    }

    // Those of them that lie beyond a side as y does, of a y in each lane; a bit each.
    [[nodiscard]] HWY_INLINE hn::Vec<Whole> with(const Vec3V& y) const {
        const Whole whole;
        auto both = hn::Zero(whole);
        const auto add = [&](V distance, unsigned lanes_beyond) HWY_ATTR {
            const auto beyond = hn::RebindMask(whole, hn::Ge(distance, all(delta_)));
            both = hn::Or(both, hn::IfThenElseZero(beyond, hn::Set(whole, static_cast<std::int32_t>(lanes_beyond))));
        };
        for (std::size_t k = 0; k < 3; ++k) {
            if (below_[k] != 0) add(hn::Sub(all(obstacle_.lo[k]), along(y, k)), below_[k]);
            if (above_[k] != 0) add(hn::Sub(along(y, k), all(obstacle_.hi[k])), above_[k]);
        }
        return both;
    }
    // Those beyond the sides of an axis.
    [[nodiscard]] HWY_INLINE hn::Vec<Whole> below(std::size_t k) const {
        return hn::Set(Whole(), static_cast<std::int32_t>(below_[k]));
    }
    [[nodiscard]] HWY_INLINE hn::Vec<Whole> above(std::size_t k) const {
        return hn::Set(Whole(), static_cast<std::int32_t>(above_[k]));
    }

 private:
    const Box& obstacle_;
    float delta_;
    std::array<unsigned, 3> below_{}, above_{};
};

// As Mirror::reflect, where nothing is inclined.
HWY_INLINE Vec3V reflected(const Mirror& mirror, const Vec3V& x) {
    const auto across = [&](std::size_t k, V at)
                            HWY_ATTR { return mirror.axis[k] ? hn::Sub(all(2 * mirror.plane[k]), at) : at; };
    return {across(0, x.x), across(1, x.y), across(2, x.z)};
}

// Writes the lanes that are near to each of the chosen particles.
static HWY_NOINLINE void find_near_lanes(const Vec3V& image, float h, const NearParticlesOfCluster& near,
                                         const std::uint32_t* chosen, std::size_t n, std::uint32_t* near_lanes) {
    const ConstVectorArrays at{near.x.data(), near.y.data(), near.z.data()};
    const V h2 = all(h * h);
    const Vec3V x = image;
    for (std::size_t c = 0; c < n; ++c) {
        const Vec3V way = way_from(x, at, chosen[c]);
        const V r2 = hn::Add(hn::Add(hn::Mul(way.x, way.x), hn::Mul(way.y, way.y)), hn::Mul(way.z, way.z));
        near_lanes[c] = bits_of(hn::Lt(r2, h2));
    }
}

// Appends to the list of a block what a cluster sees.
class Appender {
 public:
    HWY_INLINE Appender(const NearParticlesOfCluster& near, std::size_t first, NeighbourBlock& block,
                        std::uint16_t* shares)
        : j_(near.j.data()), masks_(lane_masks(block)), list_(block.j.data()), end_(first), shares_(shares) {}

    // Appends near particle e if some lane sees it: as a whole,
    HWY_INLINE void add_whole(std::uint32_t e, unsigned seen) {
        hn::StoreU(hn::Set(Stored(), static_cast<std::uint16_t>(whole_share)), Stored(), shares_);
        add(e, seen);
    }
    // or those of the near lanes that see some of it.
    HWY_INLINE void add_part(std::uint32_t e, unsigned near_lanes, V share) {
        const Whole whole;
        const auto units = hn::NearestInt(hn::Mul(share, all(whole_share)));
        const unsigned seen = near_lanes & bits_of(hn::RebindMask(lanes, hn::Gt(units, hn::Zero(whole))));
        put_together(units, seen, shares_);
        add(e, seen);
    }

    [[nodiscard]] HWY_INLINE std::size_t end() const { return end_; }
    [[nodiscard]] HWY_INLINE std::uint16_t* shares() const { return shares_; }

 private:
    HWY_INLINE void add(std::uint32_t e, unsigned seen) {
        list_[end_] = j_[e];
        masks_[end_] = static_cast<LaneMask>(seen);
        end_ += seen != 0 ? 1U : 0U;
        shares_ += std::popcount(seen);
    }

    const std::uint32_t* j_;
    LaneMask* masks_;
    std::uint32_t* list_;
    std::size_t end_;
    std::uint16_t* shares_;
};

std::size_t FindSeenPast(const Watchers& watchers, const Sight& sight, const Box& box, float h,
                         NearParticlesOfCluster& near, std::size_t first, NeighbourBlock& block,
                         std::uint16_t*& shares) {
    const Whole whole;
    const Numbers numbers;
    const Vec3V x = load(watchers.places);
    const ConstVectorArrays at{near.x.data(), near.y.data(), near.z.data()};
    const std::size_t size = near.size;
    std::int32_t* const free = near.lanes.data();  // those that surely see each particle
    std::fill_n(free, size, -1);
    for (const Box& obstacle : watchers.obstacles) {
        const Sides sides(obstacle, x, watchers.delta);
        for (std::size_t m = 0; m < size; m += cluster_size) {
            const auto both = sides.with(reflected(sight.mirror, load(at, m)));
            hn::StoreU(hn::And(both, hn::LoadU(whole, free + m)), whole, free + m);
        }
    }
    std::uint32_t* const chosen = near.chosen.data();
    std::uint32_t* const near_lanes = near.near_lanes.data();
    std::size_t n = 0;
    const NearBox near_box(box, h);
    const auto first_numbers = hn::Iota(numbers, 0);
    for (std::size_t m = 0; m < size; m += cluster_size) {
        const unsigned here = near_box(load(at, m)) & first_lanes(size - m);
        put_together(hn::Add(first_numbers, hn::Set(numbers, static_cast<std::uint32_t>(m))), here, chosen + n);
        n += static_cast<std::size_t>(std::popcount(here));
    }
    find_near_lanes(load(sight.image), h, near, chosen, n, near_lanes);
    Appender to(near, first, block, shares);
    for (std::size_t c = 0; c < n; ++c) {
        const std::uint32_t e = chosen[c];
        const unsigned lanes_near = near_lanes[c];
        if ((lanes_near & ~static_cast<unsigned>(free[e])) == 0) {
            to.add_whole(e, lanes_near);
        } else {
            const Vec3 y = sight.mirror.reflect({near.x[e], near.y[e], near.z[e]});
            to.add_part(e, lanes_near,
                        seen_past_all(watchers.obstacles, watchers.box, x, y, lanes_of(lanes_near), watchers.delta));
        }
    }
    shares = to.shares();
    return to.end();
}

// How far apart two boxes are along two axes, m.
static float distance_between(const Box& a, const Box& b, std::size_t k, std::size_t m) {
    const auto gap = [&](std::size_t axis) {
        return std::max({a.lo[axis] - b.hi[axis], b.lo[axis] - a.hi[axis], 0.0F});
    };
    return std::sqrt(gap(k) * gap(k) + gap(m) * gap(m));
}

void FindBeforeFace(const Watchers& watchers, const Mirror& mirror, const Box& obstacle, float h,
                    const NearParticlesOfCluster& near, BeforeFace& before) {
    const Whole whole;
    const Numbers numbers;
    const std::size_t k = mirror.obstacle_axis;
    before.size = 0;
    // Seen along an edge, a line that counts passes within that edge, or outside of it by less than delta: it comes within 3/2 delta
    // of the face, or one of its ends does.
    Box flat = obstacle;
    flat.lo[k] = flat.hi[k] = mirror.plane[k];
    std::array<float, 3> reach{};
    for (const std::size_t b : {std::size_t{0}, std::size_t{2}}) {
        if (b == k) continue;
        reach[b] = (1 + for_rounding) * h + 3 * watchers.delta - distance_between(watchers.box, flat, k, b);
        if (reach[b] <= 0) return;
    }
    const Vec3V x = load(watchers.places);
    const Face face(obstacle, mirror, x, watchers.delta);
    const auto in_front = hn::Set(whole, static_cast<std::int32_t>(face.lanes_in_front()));
    const Sides sides(obstacle, x, watchers.delta);
    const std::array<const float*, 3> at{near.x.data(), near.y.data(), near.z.data()};
    const V side = all(face.side()), plane = all(mirror.plane[k]), delta = all(watchers.delta);
    const V zero = hn::Zero(lanes);
    const auto first_numbers = hn::Iota(numbers, 0);
    const std::size_t size = near.size;
    std::uint32_t *const e = before.e.data(), *const lanes_of = before.lanes.data();
    std::size_t found = 0;
    for (std::size_t m = 0; m < size; m += cluster_size) {
        const V distance = hn::Mul(side, hn::Sub(hn::LoadU(lanes, at[k] + m), plane));
        Seen some = hn::Ge(distance, zero);
        auto left = in_front;
        for (const std::size_t b : {std::size_t{0}, std::size_t{2}}) {
            if (b == k) continue;
            V y = hn::LoadU(lanes, at[b] + m);
            if (mirror.axis[b]) y = hn::Sub(all(2 * mirror.plane[b]), y);
            const V below = hn::Sub(all(obstacle.lo[b]), y), above = hn::Sub(y, all(obstacle.hi[b]));
            const V gap = hn::Max(hn::Max(below, above), zero);
            const V square = hn::MulAdd(gap, gap, hn::Mul(distance, distance));
            some = hn::And(some, hn::Lt(square, all(reach[b] * reach[b])));
            left = hn::AndNot(hn::IfThenElseZero(hn::RebindMask(whole, hn::Ge(below, delta)), sides.below(b)), left);
            left = hn::AndNot(hn::IfThenElseZero(hn::RebindMask(whole, hn::Ge(above, delta)), sides.above(b)), left);
        }
        some = hn::And(some, hn::RebindMask(lanes, hn::Ne(left, hn::Zero(whole))));
        const unsigned here = bits_of(some) & first_lanes(size - m);
        put_together(hn::Add(first_numbers, hn::Set(numbers, static_cast<std::uint32_t>(m))), here, e + found);
        put_together(hn::BitCast(numbers, left), here, lanes_of + found);
        found += static_cast<std::size_t>(std::popcount(here));
    }
    std::fill_n(before.known.data(), found, std::uint8_t{0});
    before.size = found;
}

std::size_t FindSeenInFace(const Watchers& watchers, const Mirror& mirror, const Box& obstacle, float h,
                           NearParticlesOfCluster& near, BeforeFace& before, std::size_t first, NeighbourBlock& block,
                           std::uint16_t*& shares) {
    if (before.size == 0) return first;
    const Vec3V x = load(watchers.places);
    const Face face(obstacle, mirror, x, watchers.delta);
    Appender to(near, first, block, shares);
    // No line passes the upper edge if all lines within the support radius stay delta below it: none is longer than h.
    float highest = watchers.box.hi[1] + (1 + for_rounding) * h;
    if (mirror.axis[1]) highest = std::max(highest, 2 * mirror.plane[1] - watchers.box.lo[1] + (1 + for_rounding) * h);
    const float below = mirror.obstacle_axis == 1 || obstacle.lo[1] != -Box::inf ? 0 : obstacle.hi[1] - highest;
    const float least = (1 + for_rounding) * watchers.delta;
    const float least_way = below >= least ? least * h / below : Box::inf;
    const float nearest = face.nearest();
    std::uint32_t* const near_lanes = near.near_lanes.data();
    find_near_lanes(reflected(mirror, x), h, near, before.e.data(), before.size, near_lanes);
    std::uint32_t* const chosen = near.chosen.data();
    std::size_t n = 0;
    for (std::size_t c = 0; c < before.size; ++c) {
        chosen[n] = static_cast<std::uint32_t>(c);
        n += (near_lanes[c] & before.lanes[c]) != 0 ? 1U : 0U;
    }
    for (std::size_t m = 0; m < n; ++m) {
        const std::size_t c = chosen[m];
        const std::uint32_t e = before.e[c];
        const Vec3 y{near.x[e], near.y[e], near.z[e]};
        if (nearest + face.distance(y) < least_way) {
            to.add_part(e, near_lanes[c], face.share_of(y));
            continue;
        }
        float* const known = before.share.data() + c * cluster_size;
        if (before.known[c] == 0) hn::StoreU(face.share_of(y, true), lanes, known);
        before.known[c] = 1;
        to.add_part(e, near_lanes[c], hn::LoadU(lanes, known));
    }
    shares = to.shares();
    return to.end();
}

}  // namespace wade::fluid::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace wade::fluid {

HWY_EXPORT(FindSeenPast);
HWY_EXPORT(FindBeforeFace);
HWY_EXPORT(FindSeenInFace);

std::size_t append_seen_past(const Watchers& watchers, const Sight& sight, const Box& box, float support_radius,
                             NearParticlesOfCluster& near, std::size_t first, NeighbourBlock& block,
                             std::uint16_t*& shares) {
    return HWY_DYNAMIC_DISPATCH(FindSeenPast)(watchers, sight, box, support_radius, near, first, block, shares);
}

Box box_facing(const ClusterPositions& places, const ClusterPositions& image, const Mirror& mirror, const Box& obstacle,
               float h, float delta) {
    const float reach = (1 + for_rounding) * h + delta;
    Box face = grown(obstacle, reach);
    const std::size_t axis = mirror.obstacle_axis;
    const bool upper = mirror.plane[axis] == obstacle.hi[axis];
    face.lo[axis] = upper ? mirror.plane[axis] : mirror.plane[axis] - reach;
    face.hi[axis] = upper ? mirror.plane[axis] + reach : mirror.plane[axis];
    std::array<int, largest_cluster> is_before;
    for (std::size_t l = 0; l < largest_cluster; ++l) {
        is_before[l] = static_cast<int>(places.x[l] >= face.lo[0]) & static_cast<int>(places.x[l] <= face.hi[0]) &
                       static_cast<int>(places.y[l] >= face.lo[1]) & static_cast<int>(places.y[l] <= face.hi[1]) &
                       static_cast<int>(places.z[l] >= face.lo[2]) & static_cast<int>(places.z[l] <= face.hi[2]);
    }
    Box box;
    const auto grow = [&](std::size_t k, const std::array<float, largest_cluster>& at) {
        float lo = Box::inf, hi = -Box::inf;
#pragma omp simd reduction(min : lo) reduction(max : hi)
        for (std::size_t l = 0; l < largest_cluster; ++l) {
            lo = std::min(lo, is_before[l] != 0 ? at[l] : Box::inf);
            hi = std::max(hi, is_before[l] != 0 ? at[l] : -Box::inf);
        }
        box.lo[k] = lo - for_rounding * h, box.hi[k] = hi + for_rounding * h;
    };
    grow(0, image.x), grow(1, image.y), grow(2, image.z);
    return box;
}

void note_before_face(const Watchers& watchers, const Mirror& mirror, const Box& obstacle, float support_radius,
                      const NearParticlesOfCluster& near, BeforeFace& before) {
    before.make_room(near.size);
    HWY_DYNAMIC_DISPATCH(FindBeforeFace)(watchers, mirror, obstacle, support_radius, near, before);
}

std::size_t append_seen_in_face(const Watchers& watchers, const Mirror& mirror, const Box& obstacle,
                                float support_radius, NearParticlesOfCluster& near, BeforeFace& before,
                                std::size_t first, NeighbourBlock& block, std::uint16_t*& shares) {
    return HWY_DYNAMIC_DISPATCH(FindSeenInFace)(watchers, mirror, obstacle, support_radius, near, before, first, block,
                                                shares);
}

void BeforeFace::make_room(std::size_t near) {
    const std::size_t most = near + largest_cluster;
    if (e.size() >= most) return;
    e.resize(most + most / 4);
    lanes.resize(e.size()), known.resize(e.size()), share.resize(e.size() * largest_cluster);
}

void NearParticlesOfCluster::assign(std::span<const std::uint32_t> numbers, const Particles& particles) {
    size = numbers.size();
    if (j.size() < size + largest_cluster) {
        j.resize(size + size / 4 + largest_cluster);
        x.resize(j.size()), y.resize(j.size()), z.resize(j.size()), lanes.resize(j.size());
        chosen.resize(j.size()), near_lanes.resize(j.size());
    }
    for (std::size_t k = 0; k < size; ++k) {
        j[k] = numbers[k];
        x[k] = particles.x[numbers[k]], y[k] = particles.y[numbers[k]], z[k] = particles.z[numbers[k]];
    }
}

}  // namespace wade::fluid
#endif
