#pragma once
// Visibility of one particle from a few others, by the functions of the neighbour search.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "fluid_server/neighbours/sight.hpp"
#include "fluid_server/particles/solids.hpp"

namespace wade::fluid::test {

// Returns for each particle at x the visible fraction, [0, 1], of a particle at y in a mirror, at any distance. x: at
// most the size of a cluster; boxes: possible occluders.
inline std::vector<float> shares_seen(const Solids& solids, std::span<const Vec3> x, const Vec3& y,
                                      const Mirror& mirror, std::span<const Box> boxes) {
    ClusterPositions places;
    places.size = cluster_size_here();
    Box box{{Box::inf, Box::inf, Box::inf}, {-Box::inf, -Box::inf, -Box::inf}};
    for (std::size_t l = 0; l < places.size; ++l) {
        const Vec3& at = x[std::min(l, x.size() - 1)];
        places.x[l] = at[0], places.y[l] = at[1], places.z[l] = at[2];
        for (std::size_t k = 0; k < 3; ++k) {
            box.lo[k] = std::min(box.lo[k], at[k]), box.hi[k] = std::max(box.hi[k], at[k]);
        }
    }
    Particles particles(1);
    particles.add(y, {}, Kind::fluid);
    NeighbourLists lists(1);
    NeighbourBlock& block = lists.blocks[0];
    block.j = {0};
    std::visit([](auto& masks) { masks.resize(1); }, block.lanes);
    const Sight sight{places, mirror, solids.obstacle_of(mirror), solids.facet_of(mirror)};
    const Watchers watchers{places, box, boxes, solids.sight_delta()};
    constexpr float far = 1e6F;
    std::array<std::uint16_t, largest_cluster> shares{};
    std::uint16_t* end = shares.data();
    const std::size_t kept = boxes.empty() && sight.facet != nullptr
                                 ? keep_seen_over_facet(watchers, sight, far, particles, 0, 1, block)
                                 : keep_seen_in_part(watchers, sight, far, particles, 0, 1, block, end);
    std::vector<float> seen(x.size());
    if (kept == 0) return seen;
    const std::uint16_t* next = shares.data();
    for (std::size_t l = 0; l < places.size; ++l) {
        if ((lanes_of_entry(block, 0) >> l & 1U) == 0) continue;
        const float share = end == shares.data() ? 1 : static_cast<float>(*next++) / whole_share;
        if (l < x.size()) seen[l] = share;
    }
    return seen;
}

// Returns one bit for each particle at x, set if it sees some of the particle at y.
inline unsigned lanes_that_see(const Solids& solids, std::span<const Vec3> x, const Vec3& y, const Mirror& mirror,
                               std::span<const Box> boxes) {
    const std::vector<float> seen = shares_seen(solids, x, y, mirror, boxes);
    unsigned lanes = 0;
    for (std::size_t l = 0; l < seen.size(); ++l) lanes |= seen[l] > 0 ? 1U << l : 0U;
    return lanes;
}

}  // namespace wade::fluid::test
