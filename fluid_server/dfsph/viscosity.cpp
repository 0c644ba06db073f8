#include "fluid_server/dfsph/viscosity.hpp"

#include "fluid_server/neighbours/sweeps.hpp"

namespace wade::fluid {

void apply_viscosity(Particles& p, const NeighbourLists& lists, ParticleFields& f, float viscosity, float dt) {
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
