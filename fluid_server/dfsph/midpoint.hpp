#pragma once
// Velocities centred in time, of confined water.
//
// Velocities that are made free of divergence at the end of a step lose (dt grad p)^2 / 2 of kinetic energy in it, even
// where water only turns: an error of first order in dt that feels like viscosity. Confined water has those in the middle
// of a step made free of divergence instead,
//
//   v_m = v + dt / (1 + theta) (f + a(p)),   D_i(v_m) = 0,     v' = v + (1 + theta) (v_m - v)
//
// theta = 1 is the implicit midpoint rule: v' is v mirrored at what is free of divergence (the reflection of Zehnder, Narain
// and Thomaszewski 2018) and keeps its energy, but also, for ever, what each solve has left over. theta = 0 is the implicit
// Euler rule, which forgets at once, and whose error is that of dt; that of a theta between them is that of (1 - theta) dt.
//
// Not for water with a free surface: what falls on a bed would bounce.

#include <algorithm>
#include <vector>

#include "fluid_server/particles/parallel.hpp"
#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

// theta by which the error is that of steps of a tenth of CFL 0.5: 0.9 for steps of CFL 0.5, 0 for those that something
// else keeps so short. share: dt over a step of CFL 0.5, > 0 and at most 1.
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
