#include "fluid_server/neighbours/gradient_correction.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "fluid_server/particles/parallel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fluid_server/neighbours/gradient_correction.cpp"
#include <hwy/foreach_target.h>

#include "fluid_server/neighbours/vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace wade::fluid::HWY_NAMESPACE {

void SumMoments(std::size_t b, const Particles& p, const NeighbourLists& lists, const MatrixArrays& sums) {
    const NeighbourBlock& block = lists.blocks[b];
    const V minus_unit = all(-lists.factor_unit);
    for_each_vector(p.count, b, [&](std::size_t i, std::size_t cluster) {
        Factors factors(block, cluster);
        const Vec3V x = load(places(p), i);
        MatrixV total{hn::Zero(lanes), hn::Zero(lanes), hn::Zero(lanes),
                      hn::Zero(lanes), hn::Zero(lanes), hn::Zero(lanes)};
        for_each_segment(block, cluster, [&](const NeighbourBlock::View& view, std::size_t first, std::size_t last) {
            const Vec3V seen = apply(view.map, x);
            MatrixV m{hn::Zero(lanes), hn::Zero(lanes), hn::Zero(lanes),
                      hn::Zero(lanes), hn::Zero(lanes), hn::Zero(lanes)};
            for (std::size_t k = first; k < last; ++k) {
                const Vec3V way = way_from(seen, p, block.j[k]);
                const Vec3V g = times(factors.take(k), way);
                m = {hn::MulAdd(g.x, way.x, m.xx), hn::MulAdd(g.y, way.y, m.yy), hn::MulAdd(g.z, way.z, m.zz),
                     hn::MulAdd(g.x, way.y, m.xy), hn::MulAdd(g.x, way.z, m.xz), hn::MulAdd(g.y, way.z, m.yz)};
            }
            m = conjugate(view.map.rotation, m);
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

// Calls body(vector's first particle, j, (R L_i R + L_j) (x~_i - x_j) times the factor)
// for each entry, and after each segment end_of_segment(rotation), after each vector end_of_vector(first particle).
template <typename Entry, typename EndOfSegment, typename EndOfVector>
HWY_INLINE void for_each_corrected(std::size_t b, const Particles& p, const NeighbourLists& lists,
                                   const ConstMatrixArrays& l, Entry&& entry, EndOfSegment&& end_of_segment,
                                   EndOfVector&& end_of_vector) {
    const NeighbourBlock& block = lists.blocks[b];
    for_each_vector(p.count, b, [&](std::size_t i, std::size_t cluster) {
        Factors factors(block, cluster);
        const Vec3V x = load(places(p), i);
        const MatrixV li = load(l, i);
        for_each_segment(block, cluster, [&](const NeighbourBlock::View& view, std::size_t first, std::size_t last) {
            const Vec3V seen = apply(view.map, x);
            const MatrixV own = conjugate(view.map.rotation, li);
            for (std::size_t k = first; k < last; ++k) {
                const std::size_t j = block.j[k];
                const MatrixV both{hn::Add(own.xx, all(l[0][j])), hn::Add(own.yy, all(l[1][j])),
                                   hn::Add(own.zz, all(l[2][j])), hn::Add(own.xy, all(l[3][j])),
                                   hn::Add(own.xz, all(l[4][j])), hn::Add(own.yz, all(l[5][j]))};
                entry(j, times(factors.take(k), product(both, way_from(seen, p, j))));
            }
            end_of_segment(view.map.rotation);
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

}  // namespace wade::fluid::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace wade::fluid {

HWY_EXPORT(SumMoments);
HWY_EXPORT(SumCorrectedKernel);
HWY_EXPORT(SumCorrectedGradients);
HWY_EXPORT(SumCorrectedDivergence);

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

namespace {

// Densities, as fractions, above which a particle is corrected in part and in full. The neighbours of a particle beside
// a gap lie on one side, so that their moment depends on the gap more than on the packing.
constexpr float beside_gap = 0.85F;
constexpr float within_water = 0.95F;

// Turns the first moments of the particles of a block into their corrections.
void invert(MatrixArrays& m, std::size_t begin, std::size_t end, const std::vector<float>& density) {
    for (std::size_t i = begin; i < end; ++i) {
        const float share = std::min(1.0F, (density[i] - beside_gap) / (within_water - beside_gap));
        Eigen::Matrix3f l = Eigen::Matrix3f::Identity();
        if (share > 0) {
            Eigen::Matrix3f moment;
            moment << m[0][i], m[3][i], m[4][i], m[3][i], m[1][i], m[5][i], m[4][i], m[5][i], m[2][i];
            l += share * (moment.inverse() - l);
        }
        m[0][i] = l(0, 0), m[1][i] = l(1, 1), m[2][i] = l(2, 2);
        m[3][i] = l(0, 1), m[4][i] = l(0, 2), m[5][i] = l(1, 2);
    }
}

}  // namespace

void correct_gradients(const Particles& p, const NeighbourLists& lists, GradientCorrection& correction,
                       ParticleFields& f) {
    MatrixArrays entries{};
    for (std::size_t e = 0; e < entries.size(); ++e) {
        correction.entries[e].resize(f.density.size());
        entries[e] = correction.entries[e].data();
    }
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        sum_moments(b, p, lists, entries);
        invert(entries, begin, end, f.density);
    });
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        float* const squares = f.inverse_diagonal.data();
        sum_corrected_kernel(b, p, lists, correction.arrays(), {f.gx.data(), f.gy.data(), f.gz.data()}, squares);
        for (std::size_t i = begin; i < end; ++i) {
            f.inverse_diagonal[i] = inverse_of_diagonal(f.gx[i], f.gy[i], f.gz[i], squares[i]);
        }
    });
}

}  // namespace wade::fluid
#endif
