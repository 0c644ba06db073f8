#pragma once
// Who of a few particles sees another one, asked as the search for neighbours asks.

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "fluid_server/neighbours/sight.hpp"
#include "fluid_server/particles/solids.hpp"

namespace wade::fluid::test {

// The particles at x, not more than a cluster has, that see one at y in a mirror, a bit each; boxes: what may stand in the way.
// However far away it is.
inline unsigned lanes_that_see(const Solids& solids, std::span<const Vec3> x, const Vec3& y, const Mirror& mirror,
                               std::span<const Box> boxes) {
    ClusterPlaces places;
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
    constexpr float far = 1e6F;
    if (keep_seen({places, box, boxes}, sight, far, particles, 0, 1, block) == 0) return 0;
    return lanes_of_entry(block, 0) & ((1U << x.size()) - 1);
}

}  // namespace wade::fluid::test
