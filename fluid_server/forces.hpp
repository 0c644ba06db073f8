#pragma once
// Accelerations other than pressure.

#include "fluid_server/dfsph.hpp"
#include "fluid_server/neighbours.hpp"
#include "fluid_server/particles.hpp"

namespace wade::fluid {

// Viscous acceleration of laminar flow (Morris et al. 1997):
//   a_i = 2 nu sum_j (v_i - v_j) V (dW/dr) / r
// nu: kinematic viscosity, m^2/s. The velocity of an image (ImageVelocity) makes its face free-slip or no-slip. The
// velocities are changed by dt * a.
void apply_viscosity(Particles& particles, const NeighbourLists& lists, ParticleFields& fields, float viscosity,
                     float dt);

// Adds dt * (ax, ay) to the velocity of every fluid particle.
void apply_body_force(Particles& particles, float ax, float ay, float dt);

// Uniform acceleration along x that brings the mean velocity of all fluid to -speed within dt, m/s^2.
double driving_acceleration(const Particles& particles, double speed, float dt);

}  // namespace wade::fluid
