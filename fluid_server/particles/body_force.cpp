#include "fluid_server/particles/body_force.hpp"

#include "fluid_server/particles/parallel.hpp"

namespace wade::fluid {

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
