#pragma once
// Viscosity: W5 of docs/step_of_the_water.md.

#include "fluid_server/dfsph/dfsph.hpp"
#include "fluid_server/neighbours/neighbours.hpp"
#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

// Viscous acceleration of laminar flow (Morris et al. 1997):
//   a_i = 2 nu / m sum_j (v_i - v_j) V (dW/dr) / r,   m: lattice_second_moment (kernel.hpp)
// viscosity: nu / m, m^2/s. The velocity of an image (ImageVelocity) makes its face free-slip or no-slip. The
// velocities are changed by dt * a.
void apply_viscosity(Particles& particles, const NeighbourLists& lists, ParticleFields& fields, float viscosity,
                     float dt);

}  // namespace wade::fluid
