#include "fluid_server/forces.hpp"

namespace wade::fluid {

void apply_viscosity(Particles& p, const NeighbourLists& lists, ParticleFields& f, float viscosity, float dt) {
    const float* vx = p.vx.data();
    const float* vy = p.vy.data();
    const float* vz = p.vz.data();
    for_each_list(p.count, lists, [&](std::size_t i, const NeighbourBlock& block, std::size_t place) {
        LaneSum ax;
        LaneSum ay;
        LaneSum az;
        for_each_segment(block, place, [&](const NeighbourBlock::Segment& mirror, std::size_t first, std::size_t last) {
            const std::uint32_t* j = block.j.data();
            const float* factor = block.gradient_factor.data();
            const PlaneMap m = mirror.viscous.map;
            const float vxi = vx[i] - mirror.viscous.shift[0];
            const float vyi = vy[i] - mirror.viscous.shift[1];
            const float vzi = vz[i] - mirror.viscous.shift[2];
            for (std::size_t k = first; k < last; k += lanes) {
#pragma omp simd
                for (std::size_t l = 0; l < lanes; ++l) {
                    const std::uint32_t jl = j[k + l];
                    ax.lane[l] += (vxi - (m.xx * vx[jl] + m.xy * vy[jl])) * factor[k + l];
                    ay.lane[l] += (vyi - (m.xy * vx[jl] + m.yy * vy[jl])) * factor[k + l];
                    az.lane[l] += (vzi - m.zz * vz[jl]) * factor[k + l];
                }
            }
        });
        f.ax[i] = 2 * viscosity * ax.total();
        f.ay[i] = 2 * viscosity * ay.total();
        f.az[i] = 2 * viscosity * az.total();
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
