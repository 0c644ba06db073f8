#include "fluid_server/sweeps.hpp"

#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fluid_server/sweeps.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

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

// 1 / sqrt(a) to the last bits: one step of Newton's method from the processor's estimate of 12 bits or more.
HWY_INLINE V reciprocal_sqrt(V a) {
    const V y = hn::ApproximateReciprocalSqrt(a);
    return hn::Mul(y, hn::NegMulAdd(hn::Mul(all(0.5F), a), hn::Mul(y, y), all(1.5F)));
}

// A kernel and (dW/dr) / r over its value at r = 0, of q = r / h and its inverse; zero from q = 1 on.
struct Shape {
    V value, factor;
};
HWY_INLINE Shape shape(const CubicSpline&, V q, V inverse_q) {
    const V u = hn::Max(hn::Sub(all(1), q), hn::Zero(lanes));
    const V u2 = hn::Mul(u, u);
    const auto near = hn::Le(q, all(0.5F));
    const V value_near = hn::MulAdd(hn::Mul(hn::Mul(all(6), q), q), hn::Sub(q, all(1)), all(1));
    const V value_far = hn::Mul(all(2), hn::Mul(u2, u));
    const V factor_near = hn::NegMulAdd(all(1.5F), q, all(1));
    const V factor_far = hn::Mul(hn::Mul(all(0.5F), u2), inverse_q);
    return {hn::IfThenElse(near, value_near, value_far), hn::IfThenElse(near, factor_near, factor_far)};
}
HWY_INLINE Shape shape(const WendlandC2&, V q, V) {
    const V u = hn::Max(hn::Sub(all(1), q), hn::Zero(lanes));
    const V u3 = hn::Mul(hn::Mul(u, u), u);
    return {hn::Mul(hn::Mul(u3, u), hn::MulAdd(all(4), q, all(1))), u3};
}

// The vectors of a cluster.
constexpr std::size_t parts = cluster_size / hn::MaxLanes(lanes);

// What one vector of a cluster sums up over its list.
struct VectorSums {
    Vec3V x;     // places
    Vec3V seen;  // mapped by the segment
    V density, squares;
    Vec3V gradient, of_segment;
};

// Writes the factors of a vector's lanes for which near holds, and tells which these are.
HWY_INLINE unsigned put(const hn::Vec<hn::Rebind<std::int32_t, Lanes>>& units, std::uint16_t* to) {
    const hn::Rebind<std::int32_t, Lanes> whole;
    const hn::Rebind<std::uint16_t, Lanes> stored;
    const auto near = hn::Gt(units, hn::Zero(whole));
    hn::StoreU(hn::DemoteTo(stored, hn::Compress(units, near)), stored, to);
    std::uint64_t bits = 0;
    hn::StoreMaskBits(whole, near, reinterpret_cast<std::uint8_t*>(&bits));
    return static_cast<unsigned>(bits);
}

// As vector::insert at the end, with less room to spare where it must grow.
inline void append(const std::uint16_t* begin, const std::uint16_t* end, std::vector<std::uint16_t>& to) {
    const std::size_t size = to.size() + static_cast<std::size_t>(end - begin);
    if (to.capacity() < size) to.reserve(size + size / 16);
    to.insert(to.end(), begin, end);
}

// Room of a thread.
inline std::vector<std::uint16_t>& room_for_factors() {
    thread_local std::vector<std::uint16_t> room;
    return room;
}

template <typename AnyKernel>
HWY_INLINE void sum_kernel_of(std::size_t b, const Particles& p, const AnyKernel& kernel, float volume,
                              NeighbourLists& lists, const KernelSums& sums) {
    NeighbourBlock& block = lists.blocks[b];
    const V inverse_h2 = all(kernel.inverse_support_radius() * kernel.inverse_support_radius());
    const V units = all(largest_factor_units);
    const V unit = all(lists.factor_unit);
    std::vector<std::uint16_t>& factors_of_cluster = room_for_factors();
    block.factor.clear();
    for (std::size_t c = 0; c < clusters_per_block && b * block_size + c * cluster_size < p.count; ++c) {
        const std::size_t i = b * block_size + c * cluster_size;
        block.first_factor[c] = static_cast<std::uint32_t>(block.factor.size());
        const std::size_t entries = end_of_entries(block, c) - first_entry(block, c);
        factors_of_cluster.resize(std::max(factors_of_cluster.size(), (entries + 1) * cluster_size));
        std::uint16_t* to = factors_of_cluster.data();
        VectorSums v[parts];
        for (std::size_t part = 0; part < parts; ++part) {
            v[part] = {load(places(p), i + part * hn::MaxLanes(lanes)),
                       zero3(),
                       hn::Zero(lanes),
                       hn::Zero(lanes),
                       zero3(),
                       zero3()};
        }
        for_each_segment(block, c, [&](const NeighbourBlock::Segment& s, std::size_t first, std::size_t last) {
            for (VectorSums& a : v) a.seen = apply(s.map, a.x), a.of_segment = zero3();
            for (std::size_t k = first; k < last; ++k) {
                unsigned near = 0;
                for (std::size_t part = 0; part < parts; ++part) {
                    VectorSums& a = v[part];
                    const auto lane = static_cast<unsigned>(part * hn::MaxLanes(lanes));
                    const Vec3V way = way_from(a.seen, p, block.j[k]);
                    const V r2 = dot(way, way);
                    // A distance of zero counts as a tiny one, so that its inverse stays finite.
                    const V q2 = hn::Max(hn::Mul(r2, inverse_h2), all(1e-12F));
                    const V inverse_q = reciprocal_sqrt(q2);
                    Shape w = shape(kernel, hn::Mul(q2, inverse_q), inverse_q);
                    if (s.by_sight) {
                        const hn::RebindToUnsigned<Lanes> bits;
                        const auto lane_bit = hn::Shl(hn::Set(bits, 1U), hn::Iota(bits, lane));
                        const auto seen_by = hn::RebindMask(
                            lanes, hn::TestBit(hn::Set(bits, static_cast<std::uint32_t>(block.lanes[k])), lane_bit));
                        w = {hn::IfThenElseZero(seen_by, w.value), hn::IfThenElseZero(seen_by, w.factor)};
                    }
                    const auto whole = hn::NearestInt(hn::Mul(w.factor, units));
                    const unsigned near_lanes = put(whole, to);
                    to += std::popcount(near_lanes);
                    near |= near_lanes << lane;
                    const V factor = hn::ConvertTo(lanes, whole);
                    a.density = hn::Add(a.density, w.value);
                    a.of_segment = add_product(factor, way, a.of_segment);
                    a.squares = hn::MulAdd(hn::Mul(factor, factor), r2, a.squares);
                }
                block.lanes[k] = static_cast<std::uint16_t>(near);
            }
            for (VectorSums& a : v) a.gradient = plus(a.gradient, apply(s.map.rotation, a.of_segment));
        });
        for (std::size_t part = 0; part < parts; ++part) {
            const VectorSums& a = v[part];
            const std::size_t at = i + part * hn::MaxLanes(lanes);
            hn::StoreU(hn::Mul(all(volume * kernel.value(0)), a.density), lanes, sums.density + at);
            hn::StoreU(hn::Mul(hn::Mul(unit, unit), a.squares), lanes, sums.squares + at);
            store(times(unit, a.gradient), sums.gradient, at);
        }
        append(factors_of_cluster.data(), to, block.factor);
    }
    // A vector that is loaded may reach beyond the last.
    factors_of_cluster.assign(cluster_size, 0);
    append(factors_of_cluster.data(), factors_of_cluster.data() + cluster_size, block.factor);
}

void SumKernel(std::size_t b, const Particles& p, const Kernel& kernel, float volume, NeighbourLists& lists,
               const KernelSums& sums) {
    if (const auto* spline = std::get_if<CubicSpline>(&kernel)) {
        sum_kernel_of(b, p, *spline, volume, lists, sums);
    } else {
        sum_kernel_of(b, p, std::get<WendlandC2>(kernel), volume, lists, sums);
    }
}

void SumGradients(std::size_t b, const Particles& p, const NeighbourLists& lists, const float* scalar,
                  const VectorArrays& sums) {
    const NeighbourBlock& block = lists.blocks[b];
    for_each_vector(p.count, b, [&](std::size_t i, std::size_t cluster, std::size_t lane) {
        Factors factors(block, cluster, lane);
        const Vec3V x = load(places(p), i);
        Vec3V total = zero3();
        for_each_segment(block, cluster, [&](const NeighbourBlock::Segment& s, std::size_t first, std::size_t last) {
            const Vec3V seen = apply(s.map, x);
            Vec3V sum = zero3();
            for (std::size_t k = first; k < last; ++k) {
                const std::size_t j = block.j[k];
                const V weight = hn::Mul(factors.take(k), all(scalar[j]));
                sum = add_product(weight, way_from(seen, p, j), sum);
            }
            total = plus(total, apply(s.map.rotation, sum));
        });
        store(times(all(lists.factor_unit), total), sums, i);
    });
}

void SumDivergence(std::size_t b, const Particles& p, const NeighbourLists& lists, const ConstVectorArrays& u,
                   float* sums) {
    const NeighbourBlock& block = lists.blocks[b];
    for_each_vector(p.count, b, [&](std::size_t i, std::size_t cluster, std::size_t lane) {
        Factors factors(block, cluster, lane);
        const Vec3V x = load(places(p), i);
        V sum = hn::Zero(lanes);
        for_each_segment(block, cluster, [&](const NeighbourBlock::Segment& s, std::size_t first, std::size_t last) {
            const Vec3V seen = apply(s.map, x);
            for (std::size_t k = first; k < last; ++k) {
                const std::size_t j = block.j[k];
                const Vec3V uj{all(u.x[j]), all(u.y[j]), all(u.z[j])};
                sum = hn::MulAdd(factors.take(k), dot(uj, way_from(seen, p, j)), sum);
            }
        });
        hn::StoreU(hn::Mul(all(lists.factor_unit), sum), lanes, sums + (i - b * block_size));
    });
}

void SumGradientsAndDivergence(std::size_t b, const Particles& p, const NeighbourLists& lists, const float* scalar,
                               const VectorArrays& gradients, const ConstVectorArrays& u, float* divergences) {
    const NeighbourBlock& block = lists.blocks[b];
    for_each_vector(p.count, b, [&](std::size_t i, std::size_t cluster, std::size_t lane) {
        Factors factors(block, cluster, lane);
        const Vec3V x = load(places(p), i);
        Vec3V total = zero3();
        V divergence = hn::Zero(lanes);
        for_each_segment(block, cluster, [&](const NeighbourBlock::Segment& s, std::size_t first, std::size_t last) {
            const Vec3V seen = apply(s.map, x);
            Vec3V sum = zero3();
            for (std::size_t k = first; k < last; ++k) {
                const std::size_t j = block.j[k];
                const V factor = factors.take(k);
                const Vec3V way = way_from(seen, p, j);
                sum = add_product(hn::Mul(factor, all(scalar[j])), way, sum);
                const Vec3V uj{all(u.x[j]), all(u.y[j]), all(u.z[j])};
                divergence = hn::MulAdd(factor, dot(uj, way), divergence);
            }
            total = plus(total, apply(s.map.rotation, sum));
        });
        store(times(all(lists.factor_unit), total), gradients, i);
        hn::StoreU(hn::Mul(all(lists.factor_unit), divergence), lanes, divergences + (i - b * block_size));
    });
}

void SumShear(std::size_t b, const Particles& p, const NeighbourLists& lists, const ConstVectorArrays& u,
              const VectorArrays& sums) {
    const NeighbourBlock& block = lists.blocks[b];
    for_each_vector(p.count, b, [&](std::size_t i, std::size_t cluster, std::size_t lane) {
        Factors factors(block, cluster, lane);
        const Vec3V ui = load(u, i);
        Vec3V total = zero3();
        for_each_segment(block, cluster, [&](const NeighbourBlock::Segment& s, std::size_t first, std::size_t last) {
            // u_i - (M u_j + shift): M is taken out of the sum over j.
            V weights = hn::Zero(lanes);
            Vec3V weighted = zero3();
            for (std::size_t k = first; k < last; ++k) {
                const std::size_t j = block.j[k];
                const V weight = factors.take(k);
                weights = hn::Add(weights, weight);
                weighted = add_product(weight, Vec3V{all(u.x[j]), all(u.y[j]), all(u.z[j])}, weighted);
            }
            const ImageVelocity& image = s.viscous;
            const Vec3V own{hn::Sub(ui.x, all(image.shift[0])), hn::Sub(ui.y, all(image.shift[1])),
                            hn::Sub(ui.z, all(image.shift[2]))};
            const Vec3V mirrored = apply(image.map, weighted);
            total = plus(total, Vec3V{hn::MulSub(weights, own.x, mirrored.x), hn::MulSub(weights, own.y, mirrored.y),
                                      hn::MulSub(weights, own.z, mirrored.z)});
        });
        store(times(all(lists.factor_unit), total), sums, i);
    });
}

void SumMoments(std::size_t b, const Particles& p, const NeighbourLists& lists, const MatrixArrays& sums) {
    const NeighbourBlock& block = lists.blocks[b];
    const V minus_unit = all(-lists.factor_unit);
    for_each_vector(p.count, b, [&](std::size_t i, std::size_t cluster, std::size_t lane) {
        Factors factors(block, cluster, lane);
        const Vec3V x = load(places(p), i);
        MatrixV total{hn::Zero(lanes), hn::Zero(lanes), hn::Zero(lanes),
                      hn::Zero(lanes), hn::Zero(lanes), hn::Zero(lanes)};
        for_each_segment(block, cluster, [&](const NeighbourBlock::Segment& s, std::size_t first, std::size_t last) {
            const Vec3V seen = apply(s.map, x);
            MatrixV m{hn::Zero(lanes), hn::Zero(lanes), hn::Zero(lanes),
                      hn::Zero(lanes), hn::Zero(lanes), hn::Zero(lanes)};
            for (std::size_t k = first; k < last; ++k) {
                const Vec3V way = way_from(seen, p, block.j[k]);
                const Vec3V g = times(factors.take(k), way);
                m = {hn::MulAdd(g.x, way.x, m.xx), hn::MulAdd(g.y, way.y, m.yy), hn::MulAdd(g.z, way.z, m.zz),
                     hn::MulAdd(g.x, way.y, m.xy), hn::MulAdd(g.x, way.z, m.xz), hn::MulAdd(g.y, way.z, m.yz)};
            }
            m = conjugate(s.map.rotation, m);
            total = {hn::Add(total.xx, m.xx), hn::Add(total.yy, m.yy), hn::Add(total.zz, m.zz),
                     hn::Add(total.xy, m.xy), hn::Add(total.xz, m.xz), hn::Add(total.yz, m.yz)};
        });
        hn::StoreU(hn::Mul(minus_unit, total.xx), lanes, sums[0] + i);
        hn::StoreU(hn::Mul(minus_unit, total.yy), lanes, sums[1] + i);
        hn::StoreU(hn::Mul(minus_unit, total.zz), lanes, sums[2] + i);
        hn::StoreU(hn::Mul(minus_unit, total.xy), lanes, sums[3] + i);
        hn::StoreU(hn::Mul(minus_unit, total.xz), lanes, sums[4] + i);
        hn::StoreU(hn::Mul(minus_unit, total.yz), lanes, sums[5] + i);
    });
}

// Calls body(vector's first particle, its first lane in the block, segment, j, (R L_i R + L_j) (x~_i - x_j) times the factor)
// for each entry, and after each segment end_of_segment(rotation), after each vector end_of_vector(first particle).
template <typename Entry, typename EndOfSegment, typename EndOfVector>
HWY_INLINE void for_each_corrected(std::size_t b, const Particles& p, const NeighbourLists& lists,
                                   const ConstMatrixArrays& l, Entry&& entry, EndOfSegment&& end_of_segment,
                                   EndOfVector&& end_of_vector) {
    const NeighbourBlock& block = lists.blocks[b];
    for_each_vector(p.count, b, [&](std::size_t i, std::size_t cluster, std::size_t lane) {
        Factors factors(block, cluster, lane);
        const Vec3V x = load(places(p), i);
        const MatrixV li = load(l, i);
        for_each_segment(block, cluster, [&](const NeighbourBlock::Segment& s, std::size_t first, std::size_t last) {
            const Vec3V seen = apply(s.map, x);
            const MatrixV own = conjugate(s.map.rotation, li);
            for (std::size_t k = first; k < last; ++k) {
                const std::size_t j = block.j[k];
                const MatrixV both{hn::Add(own.xx, all(l[0][j])), hn::Add(own.yy, all(l[1][j])),
                                   hn::Add(own.zz, all(l[2][j])), hn::Add(own.xy, all(l[3][j])),
                                   hn::Add(own.xz, all(l[4][j])), hn::Add(own.yz, all(l[5][j]))};
                entry(j, times(factors.take(k), product(both, way_from(seen, p, j))));
            }
            end_of_segment(s.map.rotation);
        });
        end_of_vector(i);
    });
}

void SumCorrectedKernel(std::size_t b, const Particles& p, const NeighbourLists& lists, const ConstMatrixArrays& l,
                        const VectorArrays& gradient, float* squares) {
    const V unit = all(0.5F * lists.factor_unit);
    Vec3V total = zero3();
    Vec3V sum = zero3();
    V sum_of_squares = hn::Zero(lanes);
    for_each_corrected(
        b, p, lists, l,
        [&](std::size_t, const Vec3V& g) {
            sum = plus(sum, g);
            sum_of_squares = hn::Add(sum_of_squares, dot(g, g));
        },
        [&](const PlaneMap& rotation) {
            total = plus(total, apply(rotation, sum));
            sum = zero3();
        },
        [&](std::size_t i) {
            store(times(unit, total), gradient, i);
            hn::StoreU(hn::Mul(hn::Mul(unit, unit), sum_of_squares), lanes, squares + i);
            total = zero3();
            sum_of_squares = hn::Zero(lanes);
        });
}

void SumCorrectedGradients(std::size_t b, const Particles& p, const NeighbourLists& lists, const ConstMatrixArrays& l,
                           const float* scalar, const VectorArrays& sums) {
    const V unit = all(0.5F * lists.factor_unit);
    Vec3V total = zero3();
    Vec3V sum = zero3();
    for_each_corrected(
        b, p, lists, l, [&](std::size_t j, const Vec3V& g) { sum = add_product(all(scalar[j]), g, sum); },
        [&](const PlaneMap& rotation) {
            total = plus(total, apply(rotation, sum));
            sum = zero3();
        },
        [&](std::size_t i) {
            store(times(unit, total), sums, i);
            total = zero3();
        });
}

void SumCorrectedDivergence(std::size_t b, const Particles& p, const NeighbourLists& lists, const ConstMatrixArrays& l,
                            const ConstVectorArrays& u, float* sums) {
    const V unit = all(0.5F * lists.factor_unit);
    V sum = hn::Zero(lanes);
    for_each_corrected(
        b, p, lists, l,
        [&](std::size_t j, const Vec3V& g) {
            sum = hn::Add(sum, dot(Vec3V{all(u.x[j]), all(u.y[j]), all(u.z[j])}, g));
        },
        [](const PlaneMap&) {},
        [&](std::size_t i) {
            hn::StoreU(hn::Mul(unit, sum), lanes, sums + (i - b * block_size));
            sum = hn::Zero(lanes);
        });
}

std::size_t AppendNear(const ClusterPlaces& places, const Box& box, float support_radius, const Particles& p,
                       std::span<const Run> runs, std::uint32_t* out) {
    const hn::RebindToUnsigned<Lanes> index;
    const V h2 = all(support_radius * support_radius);
    // First those near the box, a particle of the runs a lane.
    std::size_t near_box = 0;
    const auto gap = [&](const std::vector<float>& x, std::size_t m, std::size_t axis) {
        const V at = hn::LoadU(lanes, x.data() + m);
        return hn::Max(hn::Max(hn::Sub(all(box.lo[axis]), at), hn::Sub(at, all(box.hi[axis]))), hn::Zero(lanes));
    };
    for (const Run& run : runs) {
        for (std::size_t m = run.begin; m < run.end; m += hn::Lanes(lanes)) {
            const Vec3V way{gap(p.x, m, 0), gap(p.y, m, 1), gap(p.z, m, 2)};
            const auto near = hn::And(hn::Lt(dot(way, way), h2), hn::FirstN(lanes, run.end - m));
            near_box += hn::CompressStore(hn::Iota(index, static_cast<std::uint32_t>(m)), hn::RebindMask(index, near),
                                          index, out + near_box);
        }
    }
    // Then, of these, those near a place, a place a lane.
    std::size_t kept = 0;
    const ConstVectorArrays x{places.x.data(), places.y.data(), places.z.data()};
    for (std::size_t k = 0; k < near_box; ++k) {
        const std::uint32_t j = out[k];
        bool near = false;
        for (std::size_t lane = 0; lane < cluster_size; lane += hn::Lanes(lanes)) {
            const Vec3V way = way_from(load(x, lane), p, j);
            near = near || !hn::AllFalse(lanes, hn::Lt(dot(way, way), h2));
        }
        out[kept] = j;
        kept += near ? 1U : 0U;
    }
    return kept;
}

}  // namespace wade::fluid::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace wade::fluid {

HWY_EXPORT(AppendNear);
HWY_EXPORT(SumKernel);
HWY_EXPORT(SumGradients);
HWY_EXPORT(SumDivergence);
HWY_EXPORT(SumGradientsAndDivergence);
HWY_EXPORT(SumShear);
HWY_EXPORT(SumMoments);
HWY_EXPORT(SumCorrectedKernel);
HWY_EXPORT(SumCorrectedGradients);
HWY_EXPORT(SumCorrectedDivergence);

std::size_t append_near(const ClusterPlaces& places, const Box& box, float support_radius, const Particles& p,
                        std::span<const Run> runs, std::uint32_t* out) {
    return HWY_DYNAMIC_DISPATCH(AppendNear)(places, box, support_radius, p, runs, out);
}

void sum_kernel(std::size_t block, const Particles& p, const Kernel& kernel, float volume, NeighbourLists& lists,
                const KernelSums& sums) {
    HWY_DYNAMIC_DISPATCH(SumKernel)(block, p, kernel, volume, lists, sums);
}

void sum_gradients(std::size_t block, const Particles& p, const NeighbourLists& lists, const float* scalar,
                   const VectorArrays& sums) {
    HWY_DYNAMIC_DISPATCH(SumGradients)(block, p, lists, scalar, sums);
}

void sum_divergence(std::size_t block, const Particles& p, const NeighbourLists& lists, const ConstVectorArrays& u,
                    float* sums) {
    HWY_DYNAMIC_DISPATCH(SumDivergence)(block, p, lists, u, sums);
}

void sum_gradients_and_divergence(std::size_t block, const Particles& p, const NeighbourLists& lists,
                                  const float* scalar, const VectorArrays& gradients, const ConstVectorArrays& u,
                                  float* divergences) {
    HWY_DYNAMIC_DISPATCH(SumGradientsAndDivergence)(block, p, lists, scalar, gradients, u, divergences);
}

void sum_shear(std::size_t block, const Particles& p, const NeighbourLists& lists, const ConstVectorArrays& u,
               const VectorArrays& sums) {
    HWY_DYNAMIC_DISPATCH(SumShear)(block, p, lists, u, sums);
}

void sum_moments(std::size_t block, const Particles& p, const NeighbourLists& lists, const MatrixArrays& sums) {
    HWY_DYNAMIC_DISPATCH(SumMoments)(block, p, lists, sums);
}

void sum_corrected_kernel(std::size_t block, const Particles& p, const NeighbourLists& lists,
                          const ConstMatrixArrays& l, const VectorArrays& gradient, float* squares) {
    HWY_DYNAMIC_DISPATCH(SumCorrectedKernel)(block, p, lists, l, gradient, squares);
}

void sum_corrected_gradients(std::size_t block, const Particles& p, const NeighbourLists& lists,
                             const ConstMatrixArrays& l, const float* scalar, const VectorArrays& sums) {
    HWY_DYNAMIC_DISPATCH(SumCorrectedGradients)(block, p, lists, l, scalar, sums);
}

void sum_corrected_divergence(std::size_t block, const Particles& p, const NeighbourLists& lists,
                              const ConstMatrixArrays& l, const ConstVectorArrays& u, float* sums) {
    HWY_DYNAMIC_DISPATCH(SumCorrectedDivergence)(block, p, lists, l, u, sums);
}

std::string_view instruction_set() {
    return hwy::TargetName(hwy::SupportedTargets() & HWY_TARGETS & -(hwy::SupportedTargets() & HWY_TARGETS));
}

}  // namespace wade::fluid
#endif
