#include "fluid_server/neighbours/sweeps.hpp"

#include <algorithm>
#include <bit>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fluid_server/neighbours/sweeps.cpp"
#include <hwy/foreach_target.h>

#include "fluid_server/neighbours/vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace wade::fluid::HWY_NAMESPACE {

// 2^23: between it and its double a float has whole numbers only, in its last bits. A number that it is added to is rounded.
constexpr float ones_from = 8388608;

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
HWY_INLINE Shape shape(const QuarticSpline&, V q, V inverse_q) {
    const V u = hn::Max(hn::Sub(all(1), q), hn::Zero(lanes));
    const V v = hn::Max(hn::Sub(all(QuarticSpline::knot_far), q), hn::Zero(lanes));
    const V w = hn::Max(hn::Sub(all(QuarticSpline::knot_near), q), hn::Zero(lanes));
    const V u2 = hn::Mul(u, u), v2 = hn::Mul(v, v), w2 = hn::Mul(w, w);
    const V quartic = hn::MulAdd(hn::Mul(all(10), w2), w2, hn::NegMulAdd(hn::Mul(all(5), v2), v2, hn::Mul(u2, u2)));
    const V factor_near = hn::NegMulAdd(all(5), hn::Mul(q, q), all(1));
    const V cubic = hn::NegMulAdd(hn::Mul(all(5), v2), v, hn::Mul(u2, u));
    const V factor_far = hn::Mul(hn::Mul(all(4 / QuarticSpline::factor_at_zero), cubic), inverse_q);
    return {hn::Mul(all(1 / QuarticSpline::value_at_zero), quartic),
            hn::IfThenElse(hn::Le(q, all(QuarticSpline::knot_near)), factor_near, factor_far)};
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

// Entries that the first sweep has in hand at once, for three short loops, each a function of its own: a processor works on
// several entries at a time, and a compiler keeps all in registers, only where there is little to do for each.
struct Batch {
    static constexpr std::size_t size = 32;
    // A number a lane, of one entry.
    struct Entry {
        alignas(4 * cluster_size) std::array<float, cluster_size> lane;
    };
    std::array<Entry, size> squared_distance;
    std::array<Entry, size> factor;  // plus ones_from: in whole units
};

// |x~_i - x_j|^2 of n entries.
HWY_NOINLINE void find_distances(Vec3V seen, const Particles& p, const std::uint32_t* j, std::size_t n, Batch& batch) {
    const ConstVectorArrays at = places(p);
    for (std::size_t e = 0; e < n; ++e) {
        const Vec3V way = way_from(seen, at, j[e]);
        hn::Store(dot(way, way), lanes, batch.squared_distance[e].lane.data());
    }
}

// How much of its entries a cluster sees.
enum class Sees { all, by_sight, in_part };

// Factors of n entries. Returns the density with their kernels added. seen_by: the lanes that see each, if by sight; shares: of
// these lanes, if in part, which moves behind what it was read of.
template <Sees sees, typename AnyKernel>
HWY_NOINLINE V find_factors(AnyKernel kernel, const LaneMask* seen_by, const std::uint16_t*& shares, std::size_t n,
                            V density, Batch& batch) {
    const V inverse_h2 = all(kernel.inverse_support_radius() * kernel.inverse_support_radius());
    for (std::size_t e = 0; e < n; ++e) {
        // A distance of zero counts as a tiny one, so that its inverse stays finite.
        const V r2 = hn::Load(lanes, batch.squared_distance[e].lane.data());
        const V q2 = hn::Max(hn::Mul(r2, inverse_h2), all(1e-12F));
        // Root and quotient are rounded as IEEE 754 asks; processors' estimates of 1 / sqrt(x) differ.
        const V q = hn::Sqrt(q2);
        Shape w = shape(kernel, q, hn::Div(all(1), q));
        if constexpr (sees == Sees::in_part) {
            const V share = hn::Mul(hn::ConvertTo(lanes, spread(shares, seen_by[e])), all(1 / whole_share));
            shares += std::popcount(seen_by[e]);
            w = {hn::Mul(share, w.value), hn::Mul(share, w.factor)};
        } else if constexpr (sees == Sees::by_sight) {
            const auto seen = lanes_of(seen_by[e]);
            w = {hn::IfThenElseZero(seen, w.value), hn::IfThenElseZero(seen, w.factor)};
        }
        density = hn::Add(density, w.value);
        const V units = hn::Mul(w.factor, all(largest_factor_units));
        hn::Store(hn::Add(units, all(ones_from)), lanes, batch.factor[e].lane.data());
    }
    return density;
}

// Writes the factors of n entries and which lanes have one, and adds to their sums. Returns one past the last factor.
struct FactorSums {
    Vec3V gradient;  // sum_j g~_ij
    V squares;       // sum_j |g_ij|^2
};
HWY_NOINLINE std::uint16_t* keep_factors(Vec3V seen, const Particles& p, const std::uint32_t* j, std::size_t n,
                                         const Batch& batch, std::uint16_t* to, LaneMask* near_lanes,
                                         FactorSums& sums) {
    const Whole whole;
    const ConstVectorArrays at = places(p);
    Vec3V gradient = sums.gradient;
    V squares = sums.squares;
    for (std::size_t e = 0; e < n; ++e) {
        const V rounded = hn::Load(lanes, batch.factor[e].lane.data());
        const V factor = hn::Sub(rounded, all(ones_from));
        const unsigned near = bits_of(hn::Gt(factor, hn::Zero(lanes)));
        put_together(hn::And(hn::BitCast(whole, rounded), hn::Set(whole, 0xFFFF)), near, to);
        to += std::popcount(near);
        near_lanes[e] = static_cast<LaneMask>(near);
        gradient = add_product(factor, way_from(seen, at, j[e]), gradient);
        squares = hn::MulAdd(hn::Mul(factor, factor), hn::Load(lanes, batch.squared_distance[e].lane.data()), squares);
    }
    sums = {gradient, squares};
    return to;
}

// Sums over the entries of a segment for viscosity: M, of ImageVelocity, is taken out of the sum over j.
struct ShearSums {
    V weights;       // of the factors
    Vec3V weighted;  // of factor times u_j
};

// Adds n entries with their rounded factors.
HWY_NOINLINE ShearSums add_shear(const ConstVectorArrays& u, const std::uint32_t* j, std::size_t n, const Batch& batch,
                                 ShearSums sums) {
    for (std::size_t e = 0; e < n; ++e) {
        const V factor = hn::Sub(hn::Load(lanes, batch.factor[e].lane.data()), all(ones_from));
        sums.weights = hn::Add(sums.weights, factor);
        sums.weighted = add_product(factor, Vec3V{all(u.x[j[e]]), all(u.y[j[e]]), all(u.z[j[e]])}, sums.weighted);
    }
    return sums;
}

// sum_j (u_i - (M u_j + shift)) of a segment.
HWY_INLINE Vec3V finish_shear(const ShearSums& sums, const Vec3V& ui, const NeighbourBlock::View& view) {
    const ImageVelocity& image = view.viscous;
    const Vec3V own{hn::Sub(ui.x, all(image.shift[0])), hn::Sub(ui.y, all(image.shift[1])),
                    hn::Sub(ui.z, all(image.shift[2]))};
    const Vec3V mirrored = apply(image.map, sums.weighted);
    return {hn::MulSub(sums.weights, own.x, mirrored.x), hn::MulSub(sums.weights, own.y, mirrored.y),
            hn::MulSub(sums.weights, own.z, mirrored.z)};
}
HWY_INLINE Vec3V finish_shear(const ShearSums& sums, const Vec3V& ui, const NeighbourBlock::TurnedView& view) {
    const Vec3V mirrored = apply_back(view.map.turn, sums.weighted);
    return {hn::MulSub(sums.weights, ui.x, mirrored.x), hn::MulSub(sums.weights, ui.y, mirrored.y),
            hn::MulSub(sums.weights, ui.z, mirrored.z)};
}

// The templates of sweeps are static: with symbols that other files might have, the solves of straight channels took 8 % longer.
template <typename Views, bool with_shear, typename AnyKernel>
static HWY_INLINE void sum_kernel_of(std::size_t b, const Particles& p, const AnyKernel& kernel, float volume,
                                     NeighbourLists& lists, const KernelSums& sums) {
    NeighbourBlock& block = lists.blocks[b];
    const V unit = all(lists.factor_unit);
    const std::size_t entries = block.segments.empty() ? 0 : block.segments.back().end;
    std::vector<std::uint16_t>& factors = room_for_factors();
    const std::size_t most = entries * cluster_size + spread_loads;
    if (factors.size() < most) factors.resize(most);
    std::uint16_t* to = factors.data();
    LaneMask* const masks = lane_masks(block);
    const std::uint16_t* shares = block.factor.data();
    Batch batch;
    for_each_vector(p.count, b, [&](std::size_t i, std::size_t cluster) {
        block.first_factor[cluster] = static_cast<std::uint32_t>(to - factors.data());
        const Vec3V x = load(places(p), i);
        V density = hn::Zero(lanes), squares = hn::Zero(lanes);
        Vec3V gradient = zero3(), shear = zero3();
        for_each_segment(block, cluster, [&](const NeighbourBlock::View& view, std::size_t first, std::size_t last) {
            const typename Views::View& how = Views::of(block, view);
            const Vec3V seen = seen_from(how, x);
            FactorSums of_segment{zero3(), squares};
            ShearSums shear_of_segment{hn::Zero(lanes), zero3()};
            for (std::size_t k = first; k < last; k += Batch::size) {
                const std::size_t n = std::min(Batch::size, last - k);
                const std::uint32_t* const j = block.j.data() + k;
                LaneMask* const seen_by = masks + k;
                find_distances(seen, p, j, n, batch);
                density = view.in_part    ? find_factors<Sees::in_part>(kernel, seen_by, shares, n, density, batch)
                          : view.by_sight ? find_factors<Sees::by_sight>(kernel, seen_by, shares, n, density, batch)
                                          : find_factors<Sees::all>(kernel, seen_by, shares, n, density, batch);
                to = keep_factors(seen, p, j, n, batch, to, seen_by, of_segment);
                if constexpr (with_shear) shear_of_segment = add_shear(velocities(p), j, n, batch, shear_of_segment);
            }
            squares = of_segment.squares;
            gradient = plus(gradient, felt_back(how, of_segment.gradient));
            if constexpr (with_shear) {
                shear = plus(shear, finish_shear(shear_of_segment, load(velocities(p), i), how));
            }
        });
        hn::StoreU(hn::Mul(all(volume * kernel.value(0)), density), lanes, sums.density + i);
        hn::StoreU(hn::Mul(hn::Mul(unit, unit), squares), lanes, sums.squares + i);
        store(times(unit, gradient), sums.gradient, i);
        if constexpr (with_shear) store(times(unit, shear), sums.shear, i);
    });
    // What is loaded may reach beyond the last.
    std::fill_n(to, spread_loads, std::uint16_t{0});
    keep(factors.data(), to + spread_loads, block.factor);
}

void SumKernel(std::size_t b, const Particles& p, const Kernel& kernel, float volume, NeighbourLists& lists,
               const KernelSums& sums) {
    std::visit(
        [&](const auto& of_scene) {
            const bool turned = !lists.blocks[b].turned.empty();
            if (sums.shear.x != nullptr) {
                turned ? sum_kernel_of<TurnedViews, true>(b, p, of_scene, volume, lists, sums)
                       : sum_kernel_of<PlainViews, true>(b, p, of_scene, volume, lists, sums);
            } else {
                turned ? sum_kernel_of<TurnedViews, false>(b, p, of_scene, volume, lists, sums)
                       : sum_kernel_of<PlainViews, false>(b, p, of_scene, volume, lists, sums);
            }
        },
        kernel);
}

template <typename Views>
static HWY_INLINE void sum_gradients_of(std::size_t b, const Particles& p, const NeighbourLists& lists,
                                        const float* scalar, const VectorArrays& sums) {
    const NeighbourBlock& block = lists.blocks[b];
    for_each_vector(p.count, b, [&](std::size_t i, std::size_t cluster) {
        Factors factors(block, cluster);
        const Vec3V x = load(places(p), i);
        Vec3V total = zero3();
        for_each_segment(block, cluster, [&](const NeighbourBlock::View& view, std::size_t first, std::size_t last) {
            const typename Views::View& how = Views::of(block, view);
            const Vec3V seen = seen_from(how, x);
            Vec3V sum = zero3();
            for (std::size_t k = first; k < last; ++k) {
                const std::size_t j = block.j[k];
                const V weight = hn::Mul(factors.take(k), all(scalar[j]));
                sum = add_product(weight, way_from(seen, p, j), sum);
            }
            total = plus(total, felt_back(how, sum));
        });
        store(times(all(lists.factor_unit), total), sums, i);
    });
}

void SumGradients(std::size_t b, const Particles& p, const NeighbourLists& lists, const float* scalar,
                  const VectorArrays& sums) {
    if (lists.blocks[b].turned.empty()) {
        sum_gradients_of<PlainViews>(b, p, lists, scalar, sums);
    } else {
        sum_gradients_of<TurnedViews>(b, p, lists, scalar, sums);
    }
}

template <typename Views>
static HWY_INLINE void sum_divergence_of(std::size_t b, const Particles& p, const NeighbourLists& lists,
                                         const ConstVectorArrays& u, float* sums) {
    const NeighbourBlock& block = lists.blocks[b];
    for_each_vector(p.count, b, [&](std::size_t i, std::size_t cluster) {
        Factors factors(block, cluster);
        const Vec3V x = load(places(p), i);
        V sum = hn::Zero(lanes);
        for_each_segment(block, cluster, [&](const NeighbourBlock::View& view, std::size_t first, std::size_t last) {
            const typename Views::View& how = Views::of(block, view);
            const Vec3V seen = seen_from(how, x);
            for (std::size_t k = first; k < last; ++k) {
                const std::size_t j = block.j[k];
                const Vec3V uj{all(u.x[j]), all(u.y[j]), all(u.z[j])};
                sum = hn::MulAdd(factors.take(k), dot(uj, way_from(seen, p, j)), sum);
            }
        });
        hn::StoreU(hn::Mul(all(lists.factor_unit), sum), lanes, sums + (i - b * block_size));
    });
}

void SumDivergence(std::size_t b, const Particles& p, const NeighbourLists& lists, const ConstVectorArrays& u,
                   float* sums) {
    if (lists.blocks[b].turned.empty()) {
        sum_divergence_of<PlainViews>(b, p, lists, u, sums);
    } else {
        sum_divergence_of<TurnedViews>(b, p, lists, u, sums);
    }
}

template <typename Views>
static HWY_INLINE void sum_both_of(std::size_t b, const Particles& p, const NeighbourLists& lists, const float* scalar,
                                   const VectorArrays& gradients, const ConstVectorArrays& u, float* divergences) {
    const NeighbourBlock& block = lists.blocks[b];
    for_each_vector(p.count, b, [&](std::size_t i, std::size_t cluster) {
        Factors factors(block, cluster);
        const Vec3V x = load(places(p), i);
        Vec3V total = zero3();
        V divergence = hn::Zero(lanes);
        for_each_segment(block, cluster, [&](const NeighbourBlock::View& view, std::size_t first, std::size_t last) {
            const typename Views::View& how = Views::of(block, view);
            const Vec3V seen = seen_from(how, x);
            Vec3V sum = zero3();
            for (std::size_t k = first; k < last; ++k) {
                const std::size_t j = block.j[k];
                const V factor = factors.take(k);
                const Vec3V way = way_from(seen, p, j);
                sum = add_product(hn::Mul(factor, all(scalar[j])), way, sum);
                const Vec3V uj{all(u.x[j]), all(u.y[j]), all(u.z[j])};
                divergence = hn::MulAdd(factor, dot(uj, way), divergence);
            }
            total = plus(total, felt_back(how, sum));
        });
        store(times(all(lists.factor_unit), total), gradients, i);
        hn::StoreU(hn::Mul(all(lists.factor_unit), divergence), lanes, divergences + (i - b * block_size));
    });
}

void SumGradientsAndDivergence(std::size_t b, const Particles& p, const NeighbourLists& lists, const float* scalar,
                               const VectorArrays& gradients, const ConstVectorArrays& u, float* divergences) {
    if (lists.blocks[b].turned.empty()) {
        sum_both_of<PlainViews>(b, p, lists, scalar, gradients, u, divergences);
    } else {
        sum_both_of<TurnedViews>(b, p, lists, scalar, gradients, u, divergences);
    }
}

std::size_t ClusterSize() {
    return cluster_size;
}

}  // namespace wade::fluid::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace wade::fluid {

HWY_EXPORT(ClusterSize);
HWY_EXPORT(SumKernel);
HWY_EXPORT(SumGradients);
HWY_EXPORT(SumDivergence);
HWY_EXPORT(SumGradientsAndDivergence);

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

std::size_t cluster_size_here() {
    return HWY_DYNAMIC_DISPATCH(ClusterSize)();
}

void use_widest_vectors(bool widest) {
    constexpr auto up_to_avx2 = ~(std::int64_t{HWY_AVX3} | HWY_AVX3_DL);
    hwy::SetSupportedTargetsForTest(0);
    if (!widest) hwy::SetSupportedTargetsForTest(hwy::SupportedTargets() & up_to_avx2);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

std::string_view instruction_set() {
    return hwy::TargetName(hwy::SupportedTargets() & HWY_TARGETS & -(hwy::SupportedTargets() & HWY_TARGETS));
}

}  // namespace wade::fluid
#endif
