#pragma once
// Places particles at t = 0.

#include <cstdint>
#include <vector>

#include "configs/scene.hpp"
#include "fluid_server/bed_profile.hpp"
#include "fluid_server/particles.hpp"
#include "fluid_server/solids.hpp"

namespace wade::fluid {

// Sites of a lattice over a box, as near to cubic as the box allows: at least `wanted` of them, and less than a cross-
// section of the longer horizontal axis more. With wanted = 0 the counts are the extents over the spacing, rounded.
struct Lattice {
    int nx = 0, ny = 0, nz = 0;
    float dx = 0, dy = 0, dz = 0;  // m
    [[nodiscard]] std::uint64_t sites() const;
};
Lattice lattice_over(double length, double depth, double width, double spacing, std::uint64_t wanted);

// Fills a block of water with exactly round(volume / d^3) particles moving at its velocity, so that the mass is that of
// the water to within half a particle. Surplus sites are left out of the uppermost layers, evenly spread. Sites inside or
// too near to an obstacle are left out as well and are not made up for. Throws std::length_error if there is no room.
void fill_block(Particles& particles, const WaterBlock& block, double spacing,
                const std::vector<Obstacle>& obstacles = {});

// Fills a block that stands on a bed of facets up to y = depth: slabs one spacing long, each a block on the bed at its
// middle; the sum of the particles is that of the water above the bed, to within one.
void fill_above_bed(Particles& particles, const WaterBlock& block, double spacing, const std::vector<BedFacet>& bed,
                    const std::vector<Obstacle>& obstacles);

// Fills what the scene wants filled at t = 0: its river, its blocks of water.
void fill_scene(Particles& particles, const Scene& scene);

// The greatest height of water that the scene speaks of, m: sets the scale of wave speeds and of the grid.
double deepest_water(const Scene& scene);

}  // namespace wade::fluid
