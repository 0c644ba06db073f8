#pragma once
// Readings of an instrument at a fixed point.

#include <array>

#include "fluid_server/particles/particles.hpp"

namespace wade::validation {

// Pressure of the water at a point of a wall, Pa: the average of the pressures of the particles nearer than two
// spacings, weighted by the cubic spline,
//
//   p = sum_j V p_j W_j / max(sum_j V W_j, 1/4),   V = spacing^3.
//
// A wall that is wet all over has sum_j V W_j near 1/2; below half of that the point is only partly wet and the reading
// falls to 0 with the water. The average belongs to a depth of about half a spacing in front of the wall.
// point, spacing: m; rest_density: kg/m^3
double wall_pressure(const fluid::Particles& particles, const std::array<double, 3>& point, double spacing,
                     double rest_density);

// Length of a vertical wire that is wet, m: the volume of water round the wire over the area that it stands on. Each
// particle counts with (1 - |dx|/w) (1 - |dz|/w) / w^2, w = 2 spacings, which is exact for a lattice wherever the wire
// stands. Drops and a film count with their volume, air beneath a jet does not count. x, z, spacing: m
double wet_length(const fluid::Particles& particles, double x, double z, double spacing);

}  // namespace wade::validation
