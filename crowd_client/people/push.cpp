#include "crowd_client/people/push.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene/fluid.hpp"

namespace wade::crowd {

double disc_width_share(ModelKind model, const Stream& stream) {
    if (model == ModelKind::shallow_water) return 1.5;
    constexpr double of_fast_water = 1.6, mixing = 0.011;
    const double froude = stream.speed / std::sqrt(stream.gravity * stream.depth);
    return of_fast_water + mixing / (froude * froude * froude);
}

double drag_on_slowed_stream(double drag, double body_width, double disc_width) {
    constexpr double largest_thrust = 0.8;  // beyond it the stream no longer follows momentum theory
    const double thrust = std::min(largest_thrust, drag * body_width / disc_width);
    const double root = 1 + std::sqrt(1 - thrust);
    return drag * 4 / (root * root);
}

double largest_push(const PushedWater& water) {
    if (!(water.weight > 0)) return 0;
    return 0.5 * std::sqrt(water.relative.squaredNorm()) * water.weight / water.theta;
}

Vector2d push_of_walker(double k, const PushedWater& water, double dt) {
    const double speed = std::sqrt(water.relative.squaredNorm());
    if (!(speed > 0)) return Vector2d::Zero();
    return std::min(k * speed * speed * dt, largest_push(water)) / speed * water.relative;
}

Vector2d push_of_carried(double k, double mass, const PushedWater& water, double dt) {
    const double speed = std::sqrt(water.relative.squaredNorm());
    if (!(speed > 0) || !(water.weight > 0)) return Vector2d::Zero();
    const double ease = water.theta / water.weight + 1 / mass;
    const double rest = speed / (1 + k * ease * speed * dt);
    return (speed - rest) / ease / speed * water.relative;
}

double wake_deficit(double drag_width, double width, double along, double across) {
    if (!(along > width / 2) || along > longest_wake || !(drag_width > 0)) return 0;
    const double spread = drag_width * along;
    return std::min(1.0, std::sqrt(drag_width / along)) * std::exp(-4.5 * across * across / spread);
}

double widest_wake(double drag_width) {
    constexpr double least_deficit = 1e-3;
    return std::sqrt(-std::log(least_deficit) / 4.5 * drag_width * longest_wake);
}

}  // namespace wade::crowd
