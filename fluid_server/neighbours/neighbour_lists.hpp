#pragma once
// Neighbour lists of clusters.
//
// A cluster is as many particles as a vector of the processor has lanes, 16 with AVX-512 and 8 with AVX2, that follow one
// another in the sorted arrays and so lie close together. It has one list: the particles that at least one of its own may
// see. A sweep works on the whole cluster at once, one particle a lane, and takes the particles of the list one after the
// other:
//
//                       lanes: the cluster's particles
//   list    j = 17    [ g  g  0  g  g  g  .  .  0  g ]    g: a neighbour nearer than the support radius
//           j = 18    [ g  g  g  g  0  g  .  .  g  g ]    0: too far away; the kernel is zero there
//
// so that nothing is gathered. What every sweep needs, the factor of the kernel gradient, is kept for each g of this table
// in 16 bits, one after the other, with a bit a place that tells g from 0: an entry costs the list 5 bytes (with 16 lanes 6),
// a neighbour 2.
//
// A list has segments: the first holds neighbours, each further one the neighbours in another view: in a mirror
// (solids.hpp) or beyond a periodic border. There it is the cluster that moves: its lanes are mapped, x -> R x + shift, and
// the list names ordinary particles. With x~ the mapped place, V grad W at the image is R g~ where g~ = V grad W(x~_i - x_j).
// On a site the map of several walls, or of wall and ground, is a matrix Q that is not symmetric; that gradient is Q^T g~.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "fluid_server/particles/cell_grid.hpp"
#include "fluid_server/particles/parallel.hpp"
#include "fluid_server/particles/particles.hpp"
#include "fluid_server/particles/solids.hpp"

namespace wade::fluid {

static_assert(block_size % largest_cluster == 0, "a block holds whole clusters");

// Particles of a cluster on this processor: a power of two, at most largest_cluster.
[[nodiscard]] std::size_t cluster_size_here();

// A stretch of sorted particles.
struct Run {
    std::uint32_t begin = 0, end = 0;
};

// The positions of a cluster's particles, or of their images, m; lanes beyond them repeat the last position.
struct ClusterPositions {
    std::size_t size = 0;
    std::array<float, largest_cluster> x{}, y{}, z{};
};

// A mask of lanes for each entry of a list, bit l for lane l: of clusters of up to 8 particles, or of larger ones.
using LaneMasks = std::variant<std::vector<std::uint8_t>, std::vector<std::uint16_t>>;

// The lists of the clusters of one block.
struct NeighbourBlock {
    // How clusters of the block see the neighbours of a segment: as they are, in a mirror, or beyond a border.
    struct View {
        RigidMap map;                // of a cluster's places
        ImageVelocity viscous;       // for viscosity
        std::int16_t obstacle = -1;  // obstacle with the mirroring face, or -1
        std::int16_t obstacle_axis = 0;
        bool by_sight = false;  // not every near lane sees every entry: `lanes` says which do
        bool in_part = false;   // by sight, and a lane may see a part of an entry only

        bool operator==(const View&) const = default;
    };
    // Instead of `map` and `viscous` on a site, as its walls and ground have any angle; water slips along all of them.
    struct TurnedView {
        TurnedMap map;
        bool in_ground = false;   // ground is among what mirrors
        std::int32_t house = -1;  // the first wall is one of this house, or -1

        bool operator==(const TurnedView&) const = default;
    };
    struct Segment {
        std::uint32_t end = 0;   // one past its last entry; the first is the end of the segment before
        std::uint32_t view = 0;  // in `views`
    };
    std::vector<std::uint32_t> first_segment;  // of each cluster, and one past the last
    std::vector<Segment> segments;
    std::vector<View> views;         // each once
    std::vector<TurnedView> turned;  // of the views, on a site; else none
    std::vector<std::uint32_t> j;    // entries: a particle each
    LaneMasks lanes;                 // of each entry: which lanes are near and see it; from sum_kernel (sweeps.hpp) on
    // (dW/dr) / r of each entry's near lanes, in NeighbourLists::factor_unit. Until sum_kernel computes these: the
    // visible fractions, in units of 1 / whole_share, of the lanes that see entries in part, one after the other.
    std::vector<std::uint16_t> factor;
    std::vector<std::uint32_t> first_factor;  // of each cluster
};

// A factor in units of NeighbourLists::factor_unit is at most this.
inline constexpr float largest_factor_units = 65535;

// All of an entry, as a share.
inline constexpr float whole_share = 65535;

// The quantum of a factor is 1.5e-5 of its largest value, at r = 0: 2e-5 of the largest V grad W. A pair's two factors
// are the same bits, so that the forces between the two stay opposite.
struct NeighbourLists {
    std::vector<NeighbourBlock> blocks;
    std::size_t cluster_size = cluster_size_here();
    std::size_t count = 0;       // of particles that have lists
    float factor_unit = 0;       // V (dW/dr) / r that one unit stands for, 1/m^2, negative
    std::vector<float> x, y, z;  // places that the lists were made for, while the particles are elsewhere; m

    explicit NeighbourLists(std::size_t capacity)
        : blocks(block_count(capacity)), x(padded(capacity)), y(padded(capacity)), z(padded(capacity)) {
        for (NeighbourBlock& block : blocks) {
            block.first_segment.resize(clusters_per_block() + 1);
            block.first_factor.resize(clusters_per_block());
            if (cluster_size > 8) block.lanes.emplace<std::vector<std::uint16_t>>();
        }
    }
    [[nodiscard]] std::size_t clusters_per_block() const { return block_size / cluster_size; }
};

// The lanes of an entry of a block.
inline unsigned lanes_of_entry(const NeighbourBlock& block, std::size_t entry) {
    return std::visit([entry](const auto& masks) { return unsigned{masks[entry]}; }, block.lanes);
}
inline void set_lanes_of_entry(NeighbourBlock& block, std::size_t entry, unsigned lanes) {
    std::visit([&]<typename Mask>(std::vector<Mask>& masks) { masks[entry] = static_cast<Mask>(lanes); }, block.lanes);
}

// First entry of a cluster of a block.
inline std::size_t first_entry(const NeighbourBlock& block, std::size_t cluster) {
    const std::uint32_t s = block.first_segment[cluster];
    return s == 0 ? 0 : block.segments[s - 1].end;
}

// One past the last entry of a cluster of a block.
inline std::size_t end_of_entries(const NeighbourBlock& block, std::size_t cluster) {
    return first_entry(block, cluster + 1);
}

// Calls body(view, first entry, one past its last) for each segment of a cluster of a block.
template <typename Body>
void for_each_segment(const NeighbourBlock& block, std::size_t cluster, Body&& body) {
    std::size_t first = first_entry(block, cluster);
    for (std::uint32_t s = block.first_segment[cluster]; s < block.first_segment[cluster + 1]; ++s) {
        const NeighbourBlock::Segment& segment = block.segments[s];
        body(block.views[segment.view], first, static_cast<std::size_t>(segment.end));
        first = segment.end;
    }
}

// A particle i and one that it sees, j.
struct ListedPair {
    std::size_t i, j;
    const NeighbourBlock::View& view;
    const NeighbourBlock::TurnedView* turned;  // on a site; else null
    float factor;                              // V (dW/dr) / r, 1/m^2
    Vec3 gradient;                             // g~_ij, 1/m

    // Q^T g~_ij, V grad W at the image.
    [[nodiscard]] Vec3 felt() const { return turned ? turned->map.turn.back(gradient) : view.map.rotation(gradient); }
    [[nodiscard]] bool in_ground() const { return turned ? turned->in_ground : view.map.rotation.yy <= 0; }
};

// What turns the views of a block, or null.
inline const NeighbourBlock::TurnedView* turned_view(const NeighbourBlock& block, const NeighbourBlock::View& view) {
    return block.turned.empty() ? nullptr : block.turned.data() + (&view - block.views.data());
}

// Calls body(pair) for each pair of a block's particles i with a kernel that is not zero: a slow loop over the lists,
// for diagnostics and tests. Uses the positions stored in NeighbourLists.
template <typename Body>
void for_each_pair(const NeighbourLists& lists, std::size_t b, Body&& body) {
    const NeighbourBlock& block = lists.blocks[b];
    for (std::size_t c = 0; c < lists.clusters_per_block(); ++c) {
        const std::size_t begin = b * block_size + c * lists.cluster_size;
        std::size_t next = block.first_factor[c];
        for_each_segment(block, c, [&](const NeighbourBlock::View& view, std::size_t first, std::size_t last) {
            const NeighbourBlock::TurnedView* const turned = turned_view(block, view);
            for (std::size_t k = first; k < last; ++k) {
                const std::size_t j = block.j[k];
                const unsigned lanes = lanes_of_entry(block, k);
                for (std::size_t l = 0; l < lists.cluster_size; ++l) {
                    const std::size_t i = begin + l;
                    if ((lanes >> l & 1U) == 0) {
                        continue;
                    }
                    const float factor = lists.factor_unit * static_cast<float>(block.factor[next++]);
                    if (i < lists.count) {
                        const Vec3 x{lists.x[i], lists.y[i], lists.z[i]};
                        const Vec3 seen = turned ? turned->map(x) : view.map(x);
                        body(ListedPair{i,
                                        j,
                                        view,
                                        turned,
                                        factor,
                                        {factor * (seen[0] - lists.x[j]), factor * (seen[1] - lists.y[j]),
                                         factor * (seen[2] - lists.z[j])}});
                    }
                }
            }
        });
    }
}

}  // namespace wade::fluid
