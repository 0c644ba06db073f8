// Vectors of lanes, one particle a lane, for the files that Highway compiles for several instruction sets.

#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "fluid_server/sweeps.hpp"

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

// One particle a lane. Where a vector has fewer lanes than a cluster has particles, its parts go through the list in turn.
using Lanes = hn::CappedTag<float, cluster_size>;
using V = hn::Vec<Lanes>;
constexpr Lanes lanes;

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
HWY_INLINE Vec3V way_from(const Vec3V& x, const Particles& p, std::size_t j) {
    return {hn::Sub(x.x, all(p.x[j])), hn::Sub(x.y, all(p.y[j])), hn::Sub(x.z, all(p.z[j]))};
}

// Where a vector has fewer than 16 lanes: for each mask of 8 lanes, the place of lane l's value among those that are kept.
struct Places8 {
    alignas(64) std::array<std::array<std::int32_t, 8>, 256> of_mask{};
    constexpr Places8() {
        for (std::size_t mask = 0; mask < 256; ++mask) {
            for (std::size_t l = 1; l < 8; ++l) {
                of_mask[mask][l] = of_mask[mask][l - 1] + static_cast<std::int32_t>(mask >> (l - 1) & 1U);
            }
        }
    }
};

// The factors of a vector of lanes, entry after entry.
class Factors {
 public:
    HWY_INLINE Factors(const NeighbourBlock& block, std::size_t cluster, std::size_t lane)
        : block_(block), next_(block.factor.data() + block.first_factor[cluster]), lane_(lane) {}

    // Those of the next entry, which is number `entry`, in units of NeighbourLists::factor_unit; 0 in lanes that have none.
    HWY_INLINE V take(std::size_t entry) {
        const unsigned mask = block_.lanes[entry];
        const std::uint16_t* const from = next_ + std::popcount(mask & ((1U << lane_) - 1));
        next_ += std::popcount(mask);
        return hn::ConvertTo(lanes, spread(hn::PromoteTo(whole, hn::LoadU(stored, from)), mask >> lane_));
    }

 private:
    using Whole = hn::Vec<hn::Rebind<std::int32_t, Lanes>>;
    static constexpr hn::Rebind<std::uint16_t, Lanes> stored{};
    static constexpr hn::Rebind<std::int32_t, Lanes> whole{};

    // Moves the first values of v, in their order, to the lanes of the mask.
    static HWY_INLINE Whole spread(Whole v, unsigned mask) {
#if HWY_TARGET <= HWY_AVX3
        return Whole{_mm512_maskz_expand_epi32(static_cast<__mmask16>(mask), v.raw)};
#else
        static constexpr Places8 places;
        mask &= (1U << hn::MaxLanes(lanes)) - 1;
        const std::uint8_t bits[8] = {static_cast<std::uint8_t>(mask)};
        const Whole moved = hn::TableLookupLanes(v, hn::SetTableIndices(whole, places.of_mask[mask].data()));
        return hn::IfThenElseZero(hn::LoadMaskBits(whole, bits), moved);
#endif
    }

    const NeighbourBlock& block_;
    const std::uint16_t* next_;
    std::size_t lane_;
};

// Calls body(first particle of the vector, cluster, its first lane in it) for all particles of a block.
template <typename Body>
HWY_INLINE void for_each_vector(std::size_t count, std::size_t b, Body&& body) {
    for (std::size_t c = 0; c < clusters_per_block && b * block_size + c * cluster_size < count; ++c) {
        for (std::size_t lane = 0; lane < cluster_size; lane += hn::Lanes(lanes)) {
            body(b * block_size + c * cluster_size + lane, c, lane);
        }
    }
}

}  // namespace wade::fluid::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
