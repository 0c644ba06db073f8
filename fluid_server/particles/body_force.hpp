#pragma once
// Forces that act alike on all particles.

#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

// Adds dt * (ax, ay) to the velocity of every fluid particle.
void apply_body_force(Particles& particles, float ax, float ay, float dt);

// Uniform acceleration along x that brings the mean velocity of all fluid to -speed within dt, m/s^2.
double driving_acceleration(const Particles& particles, double speed, float dt);

}  // namespace wade::fluid
