#pragma once
// Viscosity: W5 of docs/step_of_the_water.md.

#include "fluid_server/dfsph/dfsph.hpp"
#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

// Viscous acceleration of laminar flow (Morris et al. 1997):
//   a_i = 2 nu / m sum_j (v_i - v_j) V (dW/dr) / r,   m: lattice_second_moment (kernel.hpp)
// viscosity: nu / m, m^2/s. The sums are those of compute_density_and_diagonal(), where the velocity of an image
// (ImageVelocity) makes its face free-slip or no-slip. The velocities are changed by dt * a.
inline void apply_viscosity(Particles& p, const ParticleFields& f, float viscosity, float dt) {
    const auto change = [&](float sum) { return dt * (sum * (2 * viscosity)); };
    for_each_particle(p.count, [&](std::size_t i) {
        if (p.kind[i] == Kind::fluid) {
            p.vx[i] += change(f.ax[i]);
            p.vy[i] += change(f.ay[i]);
            p.vz[i] += change(f.az[i]);
        }
    });
}

}  // namespace wade::fluid
