#include "fluid_server/forces.hpp"

namespace wade::fluid {

void apply_viscosity(Particles& p, const NeighbourLists& lists, ParticleFields& f, float viscosity, float dt) {
    const float* vx = p.vx.data();
    const float* vy = p.vy.data();
    const float* vz = p.vz.data();
    for_each_list(p.count, lists, [&](std::size_t i, const NeighbourBlock& block, std::size_t place) {
        float ax = 0;
        float ay = 0;
        float az = 0;
        for_each_segment(block, place, [&](const NeighbourBlock::Segment& mirror, std::size_t first, std::size_t last) {
            const std::uint32_t* j = block.j.data();
            const float* factor = block.gradient_factor.data();
            const float vxi = mirror.rx * vx[i];
            const float vyi = mirror.ry * vy[i];
            const float vzi = mirror.rz * vz[i];
            float x = 0;
            float y = 0;
            float z = 0;
#pragma omp simd reduction(+ : x, y, z)
            for (std::size_t k = first; k < last; ++k) {
                x += (vxi - vx[j[k]]) * factor[k];
                y += (vyi - vy[j[k]]) * factor[k];
                z += (vzi - vz[j[k]]) * factor[k];
            }
            ax += mirror.rx * x;
            ay += mirror.ry * y;
            az += mirror.rz * z;
        });
        f.ax[i] = 2 * viscosity * ax;
        f.ay[i] = 2 * viscosity * ay;
        f.az[i] = 2 * viscosity * az;
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
