#pragma once
// The water of a site at t = 0.

#include "configs/scene/scene.hpp"
#include "fluid_server/particles/particles.hpp"
#include "fluid_server/particles/site/site_solids.hpp"

namespace wade::fluid {

// Fills the water that a site has at t = 0, up to its levels or as deep as its raster says: columns of particles on the lattice of
// the world, each on the ground at its middle, as many in all as there is water, to within half a particle. Centres are in the
// water, however near to a wall: the water is not at rest before it has been relaxed (FluidWorld). Those that stand deeper get the
// pressure of water at rest. Throws std::length_error if there is no room.
void fill_site(Particles& particles, const Scene& scene, const SiteSolids& solids);

}  // namespace wade::fluid
