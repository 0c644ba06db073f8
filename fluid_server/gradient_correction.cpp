#include "fluid_server/gradient_correction.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace wade::fluid {
namespace {

// Densities, as fractions, from which on a particle is corrected in part and in full: the neighbours of one beside a gap lie
// on one side, and their moment says more about the gap than about the packing.
constexpr float beside_gap = 0.85F;
constexpr float within_water = 0.95F;

Eigen::Matrix3f matrix(const PlaneMap& r) {
    Eigen::Matrix3f m;
    m << r.xx, r.xy, 0, r.xy, r.yy, 0, 0, 0, r.zz;
    return m;
}

Eigen::Vector3f gradient(const NeighbourBlock& block, std::size_t pair) {
    return {block.gx[pair], block.gy[pair], block.gz[pair]};
}

// - sum_j (x_i - x_j) (x) g_ij; a gradient is (x_i - x_j) times its factor.
Eigen::Matrix3f first_moment(const NeighbourBlock& block, std::size_t place) {
    Eigen::Matrix3f moment = Eigen::Matrix3f::Zero();
    for_each_segment(block, place, [&](const NeighbourBlock::Segment& mirror, std::size_t first, std::size_t last) {
        Eigen::Matrix3f reflected = Eigen::Matrix3f::Zero();
        for (std::size_t k = first; k < last; ++k) {
            if (block.gradient_factor[k] < 0) {
                const Eigen::Vector3f g = gradient(block, k);
                reflected -= g * g.transpose() / block.gradient_factor[k];
            }
        }
        const Eigen::Matrix3f r = matrix(mirror.reflection);
        moment += r * reflected * r;
    });
    return moment;
}

}  // namespace

void correct_gradients(const Particles& p, NeighbourLists& lists, std::vector<Eigen::Matrix3f>& corrections) {
    corrections.resize(p.capacity());
    for_each_list(p.count, lists, [&](std::size_t i, const NeighbourBlock& block, std::size_t place) {
        const float share = std::min(1.0F, (lists.density[i] - beside_gap) / (within_water - beside_gap));
        const Eigen::Matrix3f identity = Eigen::Matrix3f::Identity();
        corrections[i] = identity;
        if (share > 0) {
            corrections[i] += share * (first_moment(block, place).inverse() - identity);
        }
    });
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        NeighbourBlock& block = lists.blocks[b];
        for (std::size_t i = begin; i < end; ++i) {
            for_each_segment(
                block, i - begin, [&](const NeighbourBlock::Segment& mirror, std::size_t first, std::size_t last) {
                    // The lists hold R g of an image, and its correction is R L_j R.
                    const Eigen::Matrix3f r = matrix(mirror.reflection);
                    const Eigen::Matrix3f own = r * corrections[i] * r;
                    for (std::size_t k = first; k < last; ++k) {
                        const Eigen::Vector3f h = 0.5F * (own + corrections[block.j[k]]) * gradient(block, k);
                        block.gx[k] = h.x(), block.gy[k] = h.y(), block.gz[k] = h.z();
                    }
                });
        }
    });
}

}  // namespace wade::fluid
