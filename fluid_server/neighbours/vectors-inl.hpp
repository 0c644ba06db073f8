// Vectors of lanes, one particle a lane, for the files that Highway compiles for several instruction sets.

#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "fluid_server/neighbours/neighbour_lists.hpp"
#include "fluid_server/particles/particle_fields.hpp"

// Once for each instruction set.
#if defined(WADE_VECTORS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef WADE_VECTORS_INL_HPP
#undef WADE_VECTORS_INL_HPP
#else
#define WADE_VECTORS_INL_HPP
#endif

HWY_BEFORE_NAMESPACE();
namespace wade::fluid::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// One particle a lane.
using Lanes = hn::CappedTag<float, largest_cluster>;
using V = hn::Vec<Lanes>;
constexpr Lanes lanes;

constexpr std::size_t cluster_size = hn::MaxLanes(lanes);
static_assert(largest_cluster % cluster_size == 0);

struct Vec3V {
    V x, y, z;
};
struct MatrixV {
    V xx, yy, zz, xy, xz, yz;
};

HWY_INLINE V all(float value) {
    return hn::Set(lanes, value);
}
HWY_INLINE Vec3V zero3() {
    return {hn::Zero(lanes), hn::Zero(lanes), hn::Zero(lanes)};
}
HWY_INLINE Vec3V load(const ConstVectorArrays& a, std::size_t i) {
    return {hn::LoadU(lanes, a.x + i), hn::LoadU(lanes, a.y + i), hn::LoadU(lanes, a.z + i)};
}
HWY_INLINE void store(const Vec3V& v, const VectorArrays& a, std::size_t i) {
    hn::StoreU(v.x, lanes, a.x + i);
    hn::StoreU(v.y, lanes, a.y + i);
    hn::StoreU(v.z, lanes, a.z + i);
}
HWY_INLINE MatrixV load(const ConstMatrixArrays& a, std::size_t i) {
    return {hn::LoadU(lanes, a[0] + i), hn::LoadU(lanes, a[1] + i), hn::LoadU(lanes, a[2] + i),
            hn::LoadU(lanes, a[3] + i), hn::LoadU(lanes, a[4] + i), hn::LoadU(lanes, a[5] + i)};
}
HWY_INLINE ConstVectorArrays places(const Particles& p) {
    return {p.x.data(), p.y.data(), p.z.data()};
}
HWY_INLINE ConstVectorArrays velocities(const Particles& p) {
    return {p.vx.data(), p.vy.data(), p.vz.data()};
}

HWY_INLINE Vec3V plus(const Vec3V& a, const Vec3V& b) {
    return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE Vec3V times(V s, const Vec3V& a) {
    return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
// sum + s a
HWY_INLINE Vec3V add_product(V s, const Vec3V& a, const Vec3V& sum) {
    return {hn::MulAdd(s, a.x, sum.x), hn::MulAdd(s, a.y, sum.y), hn::MulAdd(s, a.z, sum.z)};
}
HWY_INLINE V dot(const Vec3V& a, const Vec3V& b) {
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE Vec3V apply(const PlaneMap& m, const Vec3V& u) {
    return {hn::MulAdd(all(m.xx), u.x, hn::Mul(all(m.xy), u.y)), hn::MulAdd(all(m.xy), u.x, hn::Mul(all(m.yy), u.y)),
            hn::Mul(all(m.zz), u.z)};
}
HWY_INLINE Vec3V apply(const RigidMap& m, const Vec3V& x) {
    const Vec3V r = apply(m.rotation, x);
    return {hn::Add(r.x, all(m.shift[0])), hn::Add(r.y, all(m.shift[1])), hn::Add(r.z, all(m.shift[2]))};
}
HWY_INLINE Vec3V apply(const TurnedMap& m, const Vec3V& x) {
    const std::array<float, 9>& q = m.turn.q;
    const auto row = [&](std::size_t r) {
        return hn::MulAdd(all(q[r]), x.x,
                          hn::MulAdd(all(q[r + 1]), x.y, hn::MulAdd(all(q[r + 2]), x.z, all(m.shift[r / 3]))));
    };
    return {row(0), row(3), row(6)};
}
// Q^T u
HWY_INLINE Vec3V apply_back(const TurnMap& m, const Vec3V& u) {
    const std::array<float, 9>& q = m.q;
    const auto column = [&](std::size_t c) {
        return hn::MulAdd(all(q[c]), u.x, hn::MulAdd(all(q[c + 3]), u.y, hn::Mul(all(q[c + 6]), u.z)));
    };
    return {column(0), column(1), column(2)};
}
HWY_INLINE Vec3V product(const MatrixV& m, const Vec3V& v) {
    return {hn::MulAdd(m.xx, v.x, hn::MulAdd(m.xy, v.y, hn::Mul(m.xz, v.z))),
            hn::MulAdd(m.xy, v.x, hn::MulAdd(m.yy, v.y, hn::Mul(m.yz, v.z))),
            hn::MulAdd(m.xz, v.x, hn::MulAdd(m.yz, v.y, hn::Mul(m.zz, v.z)))};
}
// R m R
HWY_INLINE MatrixV conjugate(const PlaneMap& r, const MatrixV& m) {
    const Vec3V x = apply(r, Vec3V{m.xx, m.xy, m.xz});  // columns of R m
    const Vec3V y = apply(r, Vec3V{m.xy, m.yy, m.yz});
    const Vec3V z = apply(r, Vec3V{m.xz, m.yz, m.zz});
    const Vec3V row_x = apply(r, Vec3V{x.x, y.x, z.x});
    const Vec3V row_y = apply(r, Vec3V{x.y, y.y, z.y});
    const Vec3V row_z = apply(r, Vec3V{x.z, y.z, z.z});
    return {row_x.x, row_y.y, row_z.z, row_x.y, row_x.z, row_y.z};
}

// x~_i - x_j
HWY_INLINE Vec3V way_from(const Vec3V& x, const ConstVectorArrays& places, std::size_t j) {
    return {hn::Sub(x.x, all(places.x[j])), hn::Sub(x.y, all(places.y[j])), hn::Sub(x.z, all(places.z[j]))};
}
HWY_INLINE Vec3V way_from(const Vec3V& x, const Particles& p, std::size_t j) {
    return way_from(x, places(p), j);
}

// A mask of lanes as the lists keep it, a bit each.
using LaneMask = std::conditional_t<(cluster_size > 8), std::uint16_t, std::uint8_t>;

// The masks of a block's entries.
HWY_INLINE const LaneMask* lane_masks(const NeighbourBlock& block) {
    return std::get<std::vector<LaneMask>>(block.lanes).data();
}
HWY_INLINE LaneMask* lane_masks(NeighbourBlock& block) {
    return std::get<std::vector<LaneMask>>(block.lanes).data();
}

// Returns the lanes of a mask as bits.
HWY_INLINE unsigned bits_of(hn::Mask<Lanes> mask) {
    LaneMask bits = 0;
    hn::StoreMaskBits(lanes, mask, reinterpret_cast<std::uint8_t*>(&bits));
    return bits;
}

// Returns the mask of the lanes with a set bit.
HWY_INLINE hn::Mask<Lanes> lanes_of(unsigned bits) {
    const hn::RebindToUnsigned<Lanes> whole;
    const auto lane_bit = hn::Shl(hn::Set(whole, 1U), hn::Iota(whole, 0));
    return hn::RebindMask(lanes, hn::TestBit(hn::Set(whole, bits), lane_bit));
}

// The bits of the first n lanes, of all if there are fewer.
HWY_INLINE unsigned first_lanes(std::size_t n) {
    return n < cluster_size ? (1U << n) - 1 : ~0U;
}

// Which of some places are nearer than h to a box, a bit each.
class NearBox {
 public:
    HWY_INLINE NearBox(const Box& box, float h)
        : lo_{all(box.lo[0]), all(box.lo[1]), all(box.lo[2])},
          hi_{all(box.hi[0]), all(box.hi[1]), all(box.hi[2])},
          h2_(all(h * h)) {}
    HWY_INLINE unsigned operator()(const Vec3V& x) const {
        const auto gap = [](V at, V least, V most) HWY_ATTR {
            return hn::Max(hn::Max(hn::Sub(least, at), hn::Sub(at, most)), hn::Zero(lanes));
        };
        const Vec3V way{gap(x.x, lo_.x, hi_.x), gap(x.y, lo_.y, hi_.y), gap(x.z, lo_.z, hi_.z)};
        return bits_of(hn::Lt(dot(way, way), h2_));
    }

 private:
    Vec3V lo_, hi_;
    V h2_;
};

// Which bytes make 8 values of 16 bits of 8 others, for each mask of 8 lanes.
struct Moves8 {
    alignas(64) std::array<std::array<std::uint8_t, 16>, 256> of_mask{};

    constexpr void set(std::size_t mask, std::size_t to, std::size_t from) {
        of_mask[mask][2 * to] = static_cast<std::uint8_t>(2 * from);
        of_mask[mask][2 * to + 1] = static_cast<std::uint8_t>(2 * from + 1);
    }
};
// The values of the mask's lanes one after the other, then zeros.
constexpr Moves8 moves_together() {
    Moves8 moves;
    for (std::size_t mask = 0; mask < 256; ++mask) {
        moves.of_mask[mask].fill(0x80);
        for (std::size_t l = 0, place = 0; l < 8; ++l) {
            if ((mask >> l & 1U) != 0) moves.set(mask, place++, l);
        }
    }
    return moves;
}

// Factors as the lists keep them, in units of NeighbourLists::factor_unit.
using Stored = hn::Rebind<std::uint16_t, Lanes>;
using Whole = hn::Rebind<std::int32_t, Lanes>;

// Which bytes make `lanes` numbers of 32 bits of values of 16, the first ones to the mask's lanes and zeros to the others.
template <std::size_t lanes>
struct MovesApart {
    alignas(64) std::array<std::array<std::uint8_t, 4 * lanes>, 1U << lanes> of_mask{};
};
template <std::size_t lanes>
constexpr MovesApart<lanes> moves_apart() {
    MovesApart<lanes> moves;
    for (std::size_t mask = 0; mask < 1U << lanes; ++mask) {
        moves.of_mask[mask].fill(0x80);
        for (std::size_t l = 0, place = 0; l < lanes; ++l) {
            if ((mask >> l & 1U) == 0) continue;
            moves.of_mask[mask][4 * l] = static_cast<std::uint8_t>(2 * place);
            moves.of_mask[mask][4 * l + 1] = static_cast<std::uint8_t>(2 * place + 1);
            ++place;
        }
    }
    return moves;
}

// Writes the values of the mask's lanes, whole numbers below 65536, one after the other; up to cluster_size of them are written.
HWY_INLINE void put_together(hn::Vec<Whole> whole, unsigned mask, std::uint16_t* to) {
#if HWY_TARGET <= HWY_AVX3
    const hn::Vec<Whole> moved{_mm512_maskz_compress_epi32(static_cast<__mmask16>(mask), whole.raw)};
    hn::StoreU(hn::DemoteTo(Stored(), moved), Stored(), to);
#else
    static constexpr Moves8 moves = moves_together();
    const hn::Repartition<std::uint8_t, Stored> bytes;
    const auto move = hn::LoadU(bytes, moves.of_mask[mask].data());
    const auto moved = hn::TableLookupBytesOr0(hn::BitCast(bytes, hn::DemoteTo(Stored(), whole)), move);
    hn::StoreU(hn::BitCast(Stored(), moved), Stored(), to);
#endif
}

// Numbers of particles.
using Numbers = hn::Rebind<std::uint32_t, Lanes>;

// The lanes of each mask of 8 lanes, one after the other. Highway 1.0's own compression copies such a table with each call.
struct Lanes8 {
    alignas(64) std::array<std::array<std::uint8_t, 8>, 256> of_mask{};
};
constexpr Lanes8 lanes_together() {
    Lanes8 lanes_of;
    for (std::size_t mask = 0; mask < 256; ++mask) {
        for (std::uint8_t l = 0, place = 0; l < 8; ++l) {
            if ((mask >> l & 1U) != 0) lanes_of.of_mask[mask][place++] = l;
        }
    }
    return lanes_of;
}

// Writes the numbers of the mask's lanes one after the other; cluster_size numbers are written.
HWY_INLINE void put_together(hn::Vec<Numbers> numbers, unsigned mask, std::uint32_t* to) {
#if HWY_TARGET <= HWY_AVX3
    const hn::Vec<Numbers> moved{_mm512_maskz_compress_epi32(static_cast<__mmask16>(mask), numbers.raw)};
#else
    static constexpr Lanes8 table = lanes_together();
    const hn::Rebind<std::uint8_t, Lanes> bytes;
    const auto from = hn::PromoteTo(Numbers(), hn::LoadU(bytes, table.of_mask[mask].data()));
    const auto moved = hn::TableLookupLanes(numbers, hn::IndicesFromVec(Numbers(), from));
#endif
    hn::StoreU(moved, Numbers(), to);
}

// How many values spread() may load.
constexpr std::size_t spread_loads = cluster_size < 8 ? 8 : cluster_size;

// The values from `from` on in the mask's lanes, 0 in the others.
HWY_INLINE hn::Vec<Whole> spread(const std::uint16_t* from, unsigned mask) {
#if HWY_TARGET <= HWY_AVX3
    const auto stored = hn::LoadU(Stored(), from);
    return hn::Vec<Whole>{_mm512_maskz_expand_epi32(static_cast<__mmask16>(mask), hn::PromoteTo(Whole(), stored).raw)};
#else
    static constexpr auto moves = moves_apart<cluster_size>();
    const hn::Repartition<std::uint8_t, Whole> bytes;
    const auto stored = hn::LoadDup128(bytes, reinterpret_cast<const std::uint8_t*>(from));
    return hn::BitCast(Whole(), hn::TableLookupBytesOr0(stored, hn::Load(bytes, moves.of_mask[mask].data())));
#endif
}

// The factors of a cluster, entry after entry.
class Factors {
 public:
    HWY_INLINE Factors(const NeighbourBlock& block, std::size_t cluster)
        : masks_(lane_masks(block)), next_(block.factor.data() + block.first_factor[cluster]) {}

    // Those of the next entry, which is number `entry`, in units of NeighbourLists::factor_unit; 0 in lanes that have none.
    HWY_INLINE V take(std::size_t entry) {
        const unsigned mask = masks_[entry];
        const std::uint16_t* const from = next_;
        next_ += std::popcount(mask);
        return hn::ConvertTo(lanes, spread(from, mask));
    }

 private:
    const LaneMask* masks_;
    const std::uint16_t* next_;
};

// How the views of a block map what a cluster looks with, and what it feels back: in straight channels,
struct PlainViews {
    using View = NeighbourBlock::View;
    static HWY_INLINE const View& of(const NeighbourBlock&, const View& view) { return view; }
};
HWY_INLINE Vec3V seen_from(const NeighbourBlock::View& view, const Vec3V& x) {
    return apply(view.map, x);
}
HWY_INLINE Vec3V felt_back(const NeighbourBlock::View& view, const Vec3V& gradient) {
    return apply(view.map.rotation, gradient);
}
// and on sites.
struct TurnedViews {
    using View = NeighbourBlock::TurnedView;
    static HWY_INLINE const View& of(const NeighbourBlock& block, const NeighbourBlock::View& view) {
        return block.turned[static_cast<std::size_t>(&view - block.views.data())];
    }
};
HWY_INLINE Vec3V seen_from(const NeighbourBlock::TurnedView& view, const Vec3V& x) {
    return apply(view.map, x);
}
HWY_INLINE Vec3V felt_back(const NeighbourBlock::TurnedView& view, const Vec3V& gradient) {
    return apply_back(view.map.turn, gradient);
}

// Calls body(first particle, cluster) for the clusters of a block.
template <typename Body>
HWY_INLINE void for_each_vector(std::size_t count, std::size_t b, Body&& body) {
    for (std::size_t c = 0; c < block_size / cluster_size && b * block_size + c * cluster_size < count; ++c) {
        body(b * block_size + c * cluster_size, c);
    }
}

}  // namespace wade::fluid::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
