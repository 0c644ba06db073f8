#pragma once
// Viscosity: W5 of docs/step_of_the_water.md.

#include "fluid_server/dfsph/dfsph.hpp"
#include "fluid_server/neighbours/neighbours.hpp"
#include "fluid_server/neighbours/sweeps.hpp"
#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

// Viscous acceleration of laminar flow (Morris et al. 1997):
//   a_i = 2 nu / m sum_j (v_i - v_j) V (dW/dr) / r,   m: lattice_second_moment (kernel.hpp)
// viscosity: nu / m, m^2/s. The velocity of an image (ImageVelocity) makes its face free-slip or no-slip. The
// velocities are changed by dt * a.
inline void apply_viscosity(Particles& p, const NeighbourLists& lists, ParticleFields& f, float viscosity, float dt) {
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        sum_shear(b, p, lists, {p.vx.data(), p.vy.data(), p.vz.data()}, {f.ax.data(), f.ay.data(), f.az.data()});
        for (std::size_t i = begin; i < end; ++i) {
            f.ax[i] *= 2 * viscosity;
            f.ay[i] *= 2 * viscosity;
            f.az[i] *= 2 * viscosity;
        }
    });
    for_each_particle(p.count, [&](std::size_t i) {
        if (p.kind[i] == Kind::fluid) {
            p.vx[i] += dt * f.ax[i];
            p.vy[i] += dt * f.ay[i];
            p.vz[i] += dt * f.az[i];
        }
    });
}

}  // namespace wade::fluid
