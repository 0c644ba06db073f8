#include "fluid_server/forces.hpp"

#include "fluid_server/sweeps.hpp"

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

void apply_body_force(Particles& p, float ax, float ay, float dt) {
    for_each_particle(p.count, [&](std::size_t i) {
        if (p.kind[i] == Kind::fluid) {
            p.vx[i] += dt * ax;
            p.vy[i] += dt * ay;
        }
    });
}

double driving_acceleration(const Particles& p, double speed, float dt) {
    double momentum = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        momentum += static_cast<double>(p.vx[i]);
    }
    return p.count == 0 ? 0 : (-speed - momentum / static_cast<double>(p.count)) / static_cast<double>(dt);
}

}  // namespace wade::fluid
