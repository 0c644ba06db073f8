#pragma once
// Forces that act alike on all particles.

#include <array>
#include <numeric>

#include "fluid_server/particles/parallel.hpp"
#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

// Adds dt * (ax, ay) to the velocity of every fluid particle.
inline void apply_body_force(Particles& p, float ax, float ay, float dt) {
    for_each_particle(p.count, [&](std::size_t i) {
        if (p.kind[i] == Kind::fluid) {
            p.vx[i] += dt * ax;
            p.vy[i] += dt * ay;
        }
    });
}

// Of all particles along x, m/s; 0 without any. Eight sums side by side, on whatever processor, as one would wait for itself.
inline double mean_velocity(const Particles& p) {
    std::array<double, 8> sums{};
    const std::size_t whole = p.count / sums.size() * sums.size();
    for (std::size_t i = 0; i < whole; i += sums.size()) {
        for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += static_cast<double>(p.vx[i + k]);
    }
    for (std::size_t i = whole; i < p.count; ++i) sums[0] += static_cast<double>(p.vx[i]);
    return p.count == 0 ? 0 : std::accumulate(sums.begin(), sums.end(), 0.0) / static_cast<double>(p.count);
}

// Uniform acceleration along x that brings the mean velocity of all fluid to -speed within dt, m/s^2.
inline double driving_acceleration(const Particles& p, double speed, float dt) {
    return p.count == 0 ? 0 : (-speed - mean_velocity(p)) / static_cast<double>(dt);
}

}  // namespace wade::fluid
