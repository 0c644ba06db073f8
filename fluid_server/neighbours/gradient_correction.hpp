#pragma once
// Kernel gradients that are exact for velocities that change linearly in space: W4 of docs/step_of_the_water.md.
//
// Sum_j (u_i - u_j) . g_ij over a packing that is not a lattice sees a divergence in water that only shears, so that
// the divergence solve holds the shear up as if the water were a soft solid. Bonet and Lok (1999) correct it by
//
//   L_i = ( - sum_j (x_i - x_j) (x) g_ij )^-1
//
// With the mean of both ends, h_ij = (L_i + L_j) g_ij / 2, the gradient of a pair is opposite for its two particles as
// before: the pressure forces keep momentum and stay the adjoint of the divergence, so that they cannot do work on
// water that is free of it. Exact for the linear field where L varies little from particle to particle.
//
// For water without a free surface only. Under weight a packing rests where its density has a minimum of potential energy;
// these gradients are not those of a density, and no such place exists: still water would tremble (a tank ten layers deep
// at 8 % of sqrt(g H) in a trial).

#include <array>
#include <vector>

#include "fluid_server/neighbours/neighbours.hpp"
#include "fluid_server/neighbours/sweeps.hpp"
#include "fluid_server/particles/particle_fields.hpp"
#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

// L_i of each particle, symmetric: the arrays of its entries xx, yy, zz, xy, xz, yz. The identity for a particle beside a
// gap.
struct GradientCorrection {
    std::array<std::vector<float>, 6> entries;

    [[nodiscard]] ConstMatrixArrays arrays() const {
        return {entries[0].data(), entries[1].data(), entries[2].data(),
                entries[3].data(), entries[4].data(), entries[5].data()};
    }
};

// Finds the correction from the factors of the lists, and with it the sum of gradients and the diagonal of each particle
// anew: from then on they are those of h_ij.
void correct_gradients(const Particles& particles, const NeighbourLists& lists, GradientCorrection& correction,
                       ParticleFields& fields);

}  // namespace wade::fluid
