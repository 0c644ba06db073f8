#include "crowd_client/equations.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "configs/scene/crowd.hpp"

namespace wade::crowd {

Vector2d motion_vector(std::span<const double> weights, std::span<const Vector2d> marker_offsets) {
    assert(weights.size() == marker_offsets.size());
    Vector2d m = Vector2d::Zero();
    for (std::size_t k = 0; k < weights.size(); ++k) m += weights[k] * marker_offsets[k];
    return m;
}

double marker_weight(double preference, double preference_sum) {
    return preference_sum > 0 ? preference / preference_sum : 0.0;
}

double marker_preference(const Vector2d& goal_offset, const Vector2d& marker_offset) {
    const double distance = std::sqrt(marker_offset.squaredNorm());
    const double norms = distance * std::sqrt(goal_offset.squaredNorm());
    const double cosine = norms > 0 ? std::clamp(goal_offset.dot(marker_offset) / norms, -1.0, 1.0) : 0.0;
    return (1 + cosine) / (1 + distance);
}

Vector2d walking_velocity(const Vector2d& motion, double desired_speed, SpeedRule rule, double dt) {
    const double length = std::sqrt(motion.squaredNorm());
    if (!(length > 0)) return Vector2d::Zero();
    double s = 0;
    switch (rule) {
        case SpeedRule::pi:
            s = std::min(std::numbers::pi * length * desired_speed, desired_speed);
            break;
        case SpeedRule::per_frame:
            s = std::min(length / dt, desired_speed);
            break;
        case SpeedRule::per_second:
            s = std::min(length, desired_speed);
            break;
    }
    return s * (motion / length);
}

Contact contact_momentum(std::span<const WaterParticle> particles) {
    Contact sum;
    for (const WaterParticle& p : particles) {
        sum.mass += p.mass;
        sum.momentum += p.mass * p.velocity;
    }
    return sum;
}

Vector2d momentum_before(double agent_mass, const Vector2d& walking, const Contact& water) {
    return agent_mass * walking + water.momentum;
}

double mass_after(double agent_mass, const Contact& water) {
    return agent_mass + water.mass;
}

Contact yielded_water(double tau, const Contact& water) {
    return {tau * water.mass, tau * water.momentum};
}

Vector2d coupled_velocity(double agent_mass, const Vector2d& walking, double tau, const Contact& water) {
    const Contact yielded = yielded_water(tau, water);
    if (!(yielded.mass > 0)) return walking;
    return momentum_before(agent_mass, walking, yielded) / mass_after(agent_mass, yielded);
}

RelaxedVelocity relaxed_velocity(double agent_mass, const Vector2d& velocity, const Vector2d& walking, double tau,
                                 const Contact& water, double dt) {
    const Vector2d steady = coupled_velocity(agent_mass, walking, tau, water);
    const Vector2d excess = velocity - steady;
    const double faded = -std::expm1(-dt / response_time);  // 1 - q, exact for short steps, too
    return {steady + excess * (faded * response_time / dt), steady + excess * (1 - faded)};
}

}  // namespace wade::crowd
