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

// 2^23: between it and its double a float has whole numbers only, in its last bits. A number that it is added to is rounded.
constexpr float ones_from = 8388608;

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

// Copies a thread's room to the list, with a little room to spare where that must grow.
inline void keep(const std::uint16_t* begin, const std::uint16_t* end, std::vector<std::uint16_t>& list) {
    const auto size = static_cast<std::size_t>(end - begin);
    if (list.capacity() < size) list.reserve(size + size / 16);
    list.assign(begin, end);
}

// Room of a thread.
inline std::vector<std::uint16_t>& room_for_factors() {
    thread_local std::vector<std::uint16_t> room;
    return room;
}

// The particles at whose lane of `seen_by` a bit is set.
HWY_INLINE hn::Mask<Lanes> lanes_of(std::uint16_t seen_by) {
    const hn::RebindToUnsigned<Lanes> bits;
    const auto lane_bit = hn::Shl(hn::Set(bits, 1U), hn::Iota(bits, 0));
    return hn::RebindMask(lanes, hn::TestBit(hn::Set(bits, static_cast<std::uint32_t>(seen_by)), lane_bit));
}

template <typename AnyKernel>
HWY_INLINE void sum_kernel_of(std::size_t b, const Particles& p, const AnyKernel& kernel, float volume,
                              NeighbourLists& lists, const KernelSums& sums) {
    NeighbourBlock& block = lists.blocks[b];
    const V inverse_h2 = all(kernel.inverse_support_radius() * kernel.inverse_support_radius());
    const V units = all(largest_factor_units);
    const V unit = all(lists.factor_unit);
    const std::size_t entries = block.segments.empty() ? 0 : block.segments.back().end;
    std::vector<std::uint16_t>& factors = room_for_factors();
    if (factors.size() < (entries + 1) * cluster_size) factors.resize((entries + 1) * cluster_size);
    std::uint16_t* to = factors.data();
    for_each_vector(p.count, b, [&](std::size_t i, std::size_t cluster) {
        block.first_factor[cluster] = static_cast<std::uint32_t>(to - factors.data());
        const Vec3V x = load(places(p), i);
        V density = hn::Zero(lanes), squares = hn::Zero(lanes);
        Vec3V gradient = zero3();
        for_each_segment(block, cluster, [&](const NeighbourBlock::Segment& s, std::size_t first, std::size_t last) {
            const Vec3V seen = apply(s.map, x);
            Vec3V sum = zero3();
            for (std::size_t k = first; k < last; ++k) {
                const Vec3V way = way_from(seen, p, block.j[k]);
                const V r2 = dot(way, way);
                // A distance of zero counts as a tiny one, so that its inverse stays finite.
                const V q2 = hn::Max(hn::Mul(r2, inverse_h2), all(1e-12F));
                const V inverse_q = reciprocal_sqrt(q2);
                Shape w = shape(kernel, hn::Mul(q2, inverse_q), inverse_q);
                if (s.by_sight) {
                    const auto seen_by = lanes_of(block.lanes[k]);
                    w = {hn::IfThenElseZero(seen_by, w.value), hn::IfThenElseZero(seen_by, w.factor)};
                }
                const V with_ones = hn::Add(hn::Mul(w.factor, units), all(ones_from));
                const V factor = hn::Sub(with_ones, all(ones_from));
                const unsigned near = bits_of(hn::Gt(factor, hn::Zero(lanes)));
                const Whole whole;
                put_together(hn::And(hn::BitCast(whole, with_ones), hn::Set(whole, 0xFFFF)), near, to);
                to += std::popcount(near);
                block.lanes[k] = static_cast<std::uint16_t>(near);
                density = hn::Add(density, w.value);
                sum = add_product(factor, way, sum);
                squares = hn::MulAdd(hn::Mul(factor, factor), r2, squares);
            }
            gradient = plus(gradient, apply(s.map.rotation, sum));
        });
        hn::StoreU(hn::Mul(all(volume * kernel.value(0)), density), lanes, sums.density + i);
        hn::StoreU(hn::Mul(hn::Mul(unit, unit), squares), lanes, sums.squares + i);
        store(times(unit, gradient), sums.gradient, i);
    });
    // A vector that is loaded may reach beyond the last.
    std::fill_n(to, cluster_size, std::uint16_t{0});
    keep(factors.data(), to + cluster_size, block.factor);
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
    for_each_vector(p.count, b, [&](std::size_t i, std::size_t cluster) {
        Factors factors(block, cluster);
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
    for_each_vector(p.count, b, [&](std::size_t i, std::size_t cluster) {
        Factors factors(block, cluster);
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
    for_each_vector(p.count, b, [&](std::size_t i, std::size_t cluster) {
        Factors factors(block, cluster);
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
    for_each_vector(p.count, b, [&](std::size_t i, std::size_t cluster) {
        Factors factors(block, cluster);
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

std::size_t FindNearBox(const Box& box, float support_radius, const Particles& p, std::span<const Run> runs,
                        std::uint32_t* out) {
    const hn::Rebind<std::int32_t, Lanes> index;
    const auto numbers = hn::Iota(index, 0);
    const V h2 = all(support_radius * support_radius);
    const Vec3V lo{all(box.lo[0]), all(box.lo[1]), all(box.lo[2])}, hi{all(box.hi[0]), all(box.hi[1]), all(box.hi[2])};
    const auto gap = [](V at, V least, V most) {
        return hn::Max(hn::Max(hn::Sub(least, at), hn::Sub(at, most)), hn::Zero(lanes));
    };
    std::size_t found = 0;
    for (const Run& run : runs) {
        const auto end = hn::Set(index, static_cast<std::int32_t>(run.end));
        // A particle of the run a lane.
        for (std::size_t m = run.begin; m < run.end; m += cluster_size) {
            const Vec3V x = load(places(p), m);
            const Vec3V way{gap(x.x, lo.x, hi.x), gap(x.y, lo.y, hi.y), gap(x.z, lo.z, hi.z)};
            const auto here = hn::Add(numbers, hn::Set(index, static_cast<std::int32_t>(m)));
            const auto near = hn::And(hn::RebindMask(index, hn::Lt(dot(way, way), h2)), hn::Lt(here, end));
            found += hn::CompressStore(here, near, index, reinterpret_cast<std::int32_t*>(out) + found);
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

std::size_t ClusterSize() {
    return cluster_size;
}

}  // namespace wade::fluid::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace wade::fluid {

HWY_EXPORT(FindNearBox);
HWY_EXPORT(FindNearPlaces);
HWY_EXPORT(ClusterSize);
HWY_EXPORT(SumKernel);
HWY_EXPORT(SumGradients);
HWY_EXPORT(SumDivergence);
HWY_EXPORT(SumGradientsAndDivergence);
HWY_EXPORT(SumShear);

std::size_t find_near_box(const Box& box, float support_radius, const Particles& p, std::span<const Run> runs,
                          std::uint32_t* out) {
    return HWY_DYNAMIC_DISPATCH(FindNearBox)(box, support_radius, p, runs, out);
}

std::size_t find_near_places(const ClusterPlaces& places, float support_radius, const Particles& p,
                             std::span<const std::uint32_t> candidates, std::uint32_t* out) {
    return HWY_DYNAMIC_DISPATCH(FindNearPlaces)(places, support_radius, p, candidates, out);
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

std::size_t cluster_size_here() {
    return HWY_DYNAMIC_DISPATCH(ClusterSize)();
}

std::string_view instruction_set() {
    return hwy::TargetName(hwy::SupportedTargets() & HWY_TARGETS & -(hwy::SupportedTargets() & HWY_TARGETS));
}

}  // namespace wade::fluid
#endif
