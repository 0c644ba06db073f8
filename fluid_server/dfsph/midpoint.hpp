#pragma once
// Time-centred velocities of confined water.
//
// Velocities that are made divergence-free at the end of a step lose (dt grad p)^2 / 2 of kinetic energy in it, even in
// pure rotation: a first-order error in dt that acts like viscosity. In confined water the velocities at the middle of
// a step are made divergence-free instead,
//
//   v_m = v + dt / (1 + theta) (f + a(p)),   D_i(v_m) = 0,     v' = v + (1 + theta) (v_m - v)
//
// theta = 1 is the implicit midpoint rule: v' is v reflected at the divergence-free velocities (Zehnder, Narain and
// Thomaszewski 2018). It conserves energy, but also keeps the residual of each solve for ever. theta = 0 is the
// implicit Euler rule: it forgets residuals at once and has the error of a step dt. A theta between them has the error
// of a step (1 - theta) dt.
//
// Not for water with a free surface: water that falls on a bed would bounce.

#include <algorithm>
#include <vector>

#include "fluid_server/particles/parallel.hpp"
#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

// Returns the theta that gives the error of steps of a tenth of CFL 0.5: 0.9 for steps of CFL 0.5, 0 if another limit
// already keeps steps so short. share: dt over a step of CFL 0.5, > 0 and at most 1.
inline float midpoint_theta(float share) {
    constexpr float share_felt = 0.1F;
    return std::max(0.0F, 1 - share_felt / share);
}

// The velocities at the start of a step, m/s.
struct StartVelocities {
    std::vector<float> vx, vy, vz;

    void keep(const Particles& p) { vx = p.vx, vy = p.vy, vz = p.vz; }
};

// From v_m to v'.
inline void go_on_from_midpoint(Particles& p, const StartVelocities& start, float theta) {
    for_each_particle(p.count, [&](std::size_t i) {
        p.vx[i] += theta * (p.vx[i] - start.vx[i]);
        p.vy[i] += theta * (p.vy[i] - start.vy[i]);
        p.vz[i] += theta * (p.vz[i] - start.vz[i]);
    });
}

}  // namespace wade::fluid
