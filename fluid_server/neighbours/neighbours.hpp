#pragma once
// Makes the neighbour lists of sorted particles, by distance and visibility.

#include "fluid_server/neighbours/neighbour_lists.hpp"
#include "fluid_server/particles/cell_grid.hpp"
#include "fluid_server/particles/particles.hpp"
#include "fluid_server/particles/site/site_solids.hpp"
#include "fluid_server/particles/solids.hpp"

namespace wade::fluid {

// Finds the lists of sorted particles: all that are nearer than the support radius, i itself among them, and all images.
// Their factors are still to be computed (sweeps.hpp).
void find_neighbours(const CellGrid& grid, const Solids& solids, const Particles& particles, float support_radius,
                     NeighbourLists& lists);

// The same on a site (billiard.hpp).
void find_neighbours(const CellGrid& grid, const SiteSolids& solids, const Particles& particles, float support_radius,
                     NeighbourLists& lists);

}  // namespace wade::fluid
