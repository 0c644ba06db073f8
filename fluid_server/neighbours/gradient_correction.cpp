#include "fluid_server/neighbours/gradient_correction.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "fluid_server/particles/parallel.hpp"

namespace wade::fluid {
namespace {

// Densities, as fractions, from which on a particle is corrected in part and in full: the neighbours of one beside a gap lie
// on one side, and their moment says more about the gap than about the packing.
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
