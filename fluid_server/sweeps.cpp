#include "fluid_server/sweeps.hpp"

#include <algorithm>
#include <bit>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fluid_server/sweeps.cpp"
#include <hwy/foreach_target.h>

#include "fluid_server/vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace wade::fluid::HWY_NAMESPACE {

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

std::string_view instruction_set() {
    return hwy::TargetName(hwy::SupportedTargets() & HWY_TARGETS & -(hwy::SupportedTargets() & HWY_TARGETS));
}

}  // namespace wade::fluid
#endif
