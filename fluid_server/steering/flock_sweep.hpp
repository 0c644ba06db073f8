#pragma once
// All that a particle feels of its neighbours, in one sweep over the lists.
//
//   separation   sum_j  w_s max((r_s / r)^2 - 1, 0) e        e: unit vector away from the neighbour, r: distance
//   cohesion   - sum_j  (w_c or w_c (r / r_c)^2) e           r_s (or 0) <= r < r_c
//   loss       - sum_j  l max(1 - r / r_l, 0) (v_i - v_j)    or v_i alone
//   alignment    w_a (mean of v_j over r < r_a  -  v_i)
//
// All but the alignment are pair forces, opposite for both where the angle is 180 degrees: they keep the momentum. They are
// divided by the particle's mass, see ParticleClass.

#include <cstddef>

#include "fluid_server/neighbours/sweeps.hpp"
#include "fluid_server/steering/settings.hpp"

namespace wade::fluid::steering {

// What a particle's class is, over the usual, lies where DFSPH keeps its pressures: it is sorted with the particles.
inline std::vector<float>& radius_factors(Particles& p) {
    return p.pressure;
}
inline std::vector<float>& mass_factors(Particles& p) {
    return p.shift_pressure;
}
inline const std::vector<float>& radius_factors(const Particles& p) {
    return p.pressure;
}
inline const std::vector<float>& mass_factors(const Particles& p) {
    return p.shift_pressure;
}

// Acceleration of the particles of a block by their neighbours, m/s^2. The lists reach at least settings.reach; velocities in
// the arrays of the particles.
void sum_flock(std::size_t block, const Particles& particles, const NeighbourLists& lists, const Settings& settings,
               const VectorArrays& acceleration);

}  // namespace wade::fluid::steering
