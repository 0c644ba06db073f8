#pragma once
// The steering model's weights, which a scene gives without units, as forces and rates of this scene.
//
// Scales: d the spacing, U^2 = g H + V^2 with H the greatest depth and V the largest velocity that the scene speaks of. A force
// is in units of U^2 / d per mass: what a column of water over one particle weighs, per particle; a rate in units of U / d.

#include <array>

#include "configs/scene/scene.hpp"

namespace wade::fluid::steering {

struct Settings {
    double spacing = 0;       // d, m
    double speed = 0;         // U, m/s
    double acceleration = 0;  // U^2 / d, m/s^2
    double rate = 0;          // U / d, 1/s

    // Of a pair of particles; radii in m, accelerations in m/s^2 at mass 1, rates in 1/s.
    float separation_radius = 0, separation = 0;
    float cohesion_radius = 0;
    float pull = 0, pull_growth = 0;  // pull + pull_growth r^2
    float no_pull_within = 0;         // m
    float loss_radius = 0, loss = 0;
    float loss_relative = 1;  // share of the neighbour's velocity in the loss: 1 relative, 0 absolute
    float alignment_radius = 0, alignment = 0;
    float separation_cos = -1, cohesion_cos = -1, alignment_cos = -1;  // of the angles
    bool plain = true;                                                 // all round, no alignment, one class

    // Of walls and bodies.
    bool wall_force = true, wall_constraint = true;
    float wall_radius = 0, wall = 0, wall_loss = 0;

    float max_acceleration = 0;  // of mass 1, m/s^2
    float max_speed = 0;         // m/s
    double reach = 0;            // the largest radius in use, m
    double wave_speed = 0;       // that limits the time step, m/s
    double loss_limit = 0;       // largest time step that the losses allow, s; infinite without
};

[[nodiscard]] Settings make_settings(const Scene& scene);

// Nearer than this fraction of its radius a push grows no more: coinciding particles stay finite.
inline constexpr float nearest_fraction = 0.3F;

// (radius / distance)^2 - 1 within the radius, at most its value at nearest_fraction; 0 beyond.
inline float push(float radius, float distance) {
    if (!(distance < radius)) return 0;
    const float q = radius / (distance > nearest_fraction * radius ? distance : nearest_fraction * radius);
    return q * q - 1;
}

// Its work from a distance to the end of the radius, m.
inline double push_work(double radius, double distance) {
    if (!(distance < radius)) return 0;
    const double nearest = static_cast<double>(nearest_fraction) * radius;
    const double at = distance > nearest ? distance : nearest;
    const double most = radius * radius / (nearest * nearest) - 1;
    return radius * radius / at - 2 * radius + at + most * (at - distance);
}

}  // namespace wade::fluid::steering
