#pragma once
// Neighbour lists: for each particle its neighbours and the images that it sees, with the kernel gradients that every
// sweep of the solver uses.

#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "fluid_server/cell_grid.hpp"
#include "fluid_server/kernel.hpp"
#include "fluid_server/parallel.hpp"
#include "fluid_server/particles.hpp"
#include "fluid_server/solids.hpp"

namespace wade::fluid {

// The kernel of a scene, of its support radius.
using Kernel = std::variant<CubicSpline, WendlandC2>;
[[nodiscard]] Kernel make_kernel(const Fluid& fluid);

// Sweeps over pairs work on this many at a time.
inline constexpr std::size_t lanes = 8;

// Neighbours of one block of particles, in segments: the first segment of a particle holds its neighbours, each further
// one the neighbours that it sees in one mirror (solids.hpp). The gradients of a segment are those of the image,
// V grad W(x_i - R x_j), reflected: g = R V grad W, so that u . (V grad W) = (R u) . g. Without a mirror R is the
// identity. A segment is filled up to a multiple of `lanes` with pairs of i and itself whose gradient is zero.
struct NeighbourBlock {
    struct Segment {
        std::uint32_t end = 0;       // one past the last pair; the first is the end of the segment before
        std::int16_t obstacle = -1;  // in whose face the images are seen, or -1
        std::int16_t obstacle_axis = 0;
        PlaneMap reflection;    // R
        ImageVelocity viscous;  // for viscosity
    };
    std::array<std::uint32_t, block_size + 1> first_segment{};
    std::vector<Segment> segments;
    std::vector<std::uint32_t> j;
    std::vector<float> gx, gy, gz;       // V = d^3; in 1/m
    std::vector<float> gradient_factor;  // V (dW/dr) / r, 1/m^2: for viscosity
    std::vector<Mirror> mirrors;         // room for the search
    void reserve(std::size_t pairs);     // room for at least so many pairs
};

struct NeighbourLists {
    std::vector<NeighbourBlock> blocks;
    std::vector<float> density;  // V sum_j W_ij, neighbours, images and i itself: density over rest density

    explicit NeighbourLists(std::size_t capacity) : blocks(block_count(capacity)), density(capacity) {}
};

// Calls body(i, its block, its place in the block) for every particle, in parallel.
template <typename Body>
void for_each_list(std::size_t n, const NeighbourLists& lists, Body&& body) {
    for_each_block(n, [&](std::size_t begin, std::size_t end, std::size_t b) {
        for (std::size_t i = begin; i < end; ++i) {
            body(i, lists.blocks[b], i - begin);
        }
    });
}

// First pair and one past the last pair of the particle at a place of its block, all segments together.
inline std::array<std::size_t, 2> all_pairs(const NeighbourBlock& block, std::size_t place) {
    const std::uint32_t first = block.first_segment[place];
    return {first == 0 ? 0U : block.segments[first - 1].end, block.segments[block.first_segment[place + 1] - 1].end};
}

// Calls body(segment, first pair, last pair) for each segment of the particle at a place of its block.
template <typename Body>
void for_each_segment(const NeighbourBlock& block, std::size_t place, Body&& body) {
    std::size_t first = all_pairs(block, place)[0];
    for (std::uint32_t s = block.first_segment[place]; s < block.first_segment[place + 1]; ++s) {
        body(block.segments[s], first, static_cast<std::size_t>(block.segments[s].end));
        first = block.segments[s].end;
    }
}

// A sum whose terms are added lane by lane: the compiler keeps it in one vector register.
struct LaneSum {
    alignas(32) std::array<float, lanes> lane{};
    [[nodiscard]] float total() const {
        return ((lane[0] + lane[4]) + (lane[1] + lane[5])) + ((lane[2] + lane[6]) + (lane[3] + lane[7]));
    }
};

// Fills the lists for sorted particles: all j != i nearer than the support radius, and all images, of i as well.
void find_neighbours(const CellGrid& grid, const Solids& solids, const Particles& particles, const Kernel& kernel,
                     float support_radius, float volume, NeighbourLists& lists);

}  // namespace wade::fluid
