#include "crowd_client/people/person.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wade::crowd {
namespace {

double ratio_of(double demand, double supply) {
    if (demand <= 0) return 0;
    return supply > 0 ? demand / supply : std::numeric_limits<double>::infinity();
}

Vector2d drag_of(double k, const Vector2d& relative) {
    return k * std::sqrt(relative.squaredNorm()) * relative;
}

// Solves M (v' - v) / dt = G + k |U - v'| (U - v') for v'. With q = U - v - dt G / M and a = dt k / M it is
// |U - v'| (1 + a |U - v'|) = |q|, along q; the root is written without a difference, so that k may be 0.
PersonStep in_the_drag(double k, double mass, const Vector2d& velocity, const Vector2d& force, const Vector2d& stream,
                       double dt) {
    PersonStep step;
    const Vector2d q = stream - velocity - dt / mass * force;
    const double a = dt * k / mass;
    const Vector2d relative = 2 / (1 + std::sqrt(1 + 4 * a * std::sqrt(q.squaredNorm()))) * q;
    step.velocity = stream - relative;
    step.ground = dt * force;
    step.drag = dt * drag_of(k, relative);
    return step;
}

}  // namespace

double submerged_share(double height, double depth) {
    const double x = std::clamp(depth / height, 0.0, 1.0);
    return 0.633 * x * x + 0.367 * x;
}

double weight_on_feet(const Body& body, double depth, const WaterProperties& water) {
    const double carried = submerged_share(body.height, depth) * water.density / body_density;
    return body.mass * water.gravity * std::max(0.0, 1 - carried);
}

double drag_upright(double height, double depth, const WaterProperties& water, double drag) {
    return 0.5 * water.density * drag * body_width_share * height * std::clamp(depth, 0.0, height);
}

double area_lying(double depth) {
    constexpr double area = 0.5, thickness = 0.25;  // m2, m
    return area * std::clamp(depth / thickness, 0.0, 1.0);
}

double drag_lying(double depth, const WaterProperties& water, double drag) {
    return 0.5 * water.density * drag * area_lying(depth);
}

double mass_with_water(double mass, double share, const WaterProperties& water) {
    return mass + water.density * mass * share / body_density;
}

double slip_demand(double k, const Vector2d& stream, const Vector2d& wanted, double friction, double weight) {
    return ratio_of(k * (stream - wanted).squaredNorm(), friction * weight);
}

double topple_demand(double k, const Vector2d& relative, double wet_height, double weight, double arm, double hold) {
    return ratio_of(k * relative.squaredNorm() * wet_height / 2, weight * arm + hold);
}

double fastest_footing(double depth) {
    constexpr double film = 0.05, shallow = 0.16, deep = 0.2, slow = 2, fast = 3;  // m; m/s
    if (depth < film) return slow * film / std::max(depth, 1e-6);
    return std::lerp(slow, fast, std::clamp((depth - shallow) / (deep - shallow), 0.0, 1.0));
}

double rush_demand(double depth, const Vector2d& stream) {
    const double fastest = fastest_footing(depth);
    return stream.squaredNorm() / (fastest * fastest);
}

double grip_in_stream(double grip, double k, double depth, const Vector2d& stream) {
    constexpr double gives_way = 0.8;  // R [A]
    const double share = std::clamp((rush_demand(depth, stream) - gives_way) / (1 - gives_way), 0.0, 1.0);
    const double fastest = fastest_footing(depth);
    return std::min(grip, std::lerp(grip, k * fastest * fastest, share));
}

double tau_of(double slip_demand) {
    return slip_demand > 1 ? 1 - 1 / slip_demand : 0;
}

PersonStep step_on_feet(const Footing& footing, const Vector2d& velocity, const Vector2d& wanted,
                        const Vector2d& stream, double dt, const Vector2d& pulls) {
    const Vector2d aim = wanted + (velocity - wanted) * std::exp(-dt / stepping_time);
    const Vector2d drag = drag_of(footing.k, stream - aim);
    const Vector2d ground = footing.mass * (aim - velocity) / dt - drag - pulls;
    const double force = std::sqrt(ground.squaredNorm());
    if (force <= footing.grip) return {aim, dt * ground, dt * drag, false};
    const Vector2d held = footing.grip / force * ground;
    PersonStep step = in_the_drag(footing.k, footing.mass, velocity, held + pulls, stream, dt);
    step.ground = dt * held;
    step.slides = true;
    return step;
}

PersonStep step_carried(double k, double mass, const Vector2d& velocity, const Vector2d& force, const Vector2d& stream,
                        double dt) {
    return in_the_drag(k, mass, velocity, force, stream, dt);
}

PersonStep step_in_water(const PersonInWater& person, const Vector2d& velocity, const Vector2d& pulls, double dt) {
    const Footing& footing = person.footing;
    PersonStep step = person.has_ground
                          ? step_on_feet(footing, velocity, person.wanted, person.stream, dt, pulls)
                          : step_carried(footing.k, footing.mass, velocity, person.swimming + pulls, person.stream, dt);
    const double impulse = std::sqrt(step.drag.squaredNorm());
    if (!(impulse > person.most_impulse)) return step;
    // Limits the impulse to the one that the water can give; a person without hold on the ground then gains less speed.
    const Vector2d excess = (1 - person.most_impulse / impulse) * step.drag;
    step.drag -= excess;
    if (!person.has_ground || step.slides) step.velocity -= excess / footing.mass;
    return step;
}

double walking_speed_ratio(Sex sex, double depth, double speed, double gravity) {
    const double unhindered = sex == Sex::male ? 0.0970 : 0.0733;  // m
    const double effective = std::sqrt(depth * depth + 2 * speed * speed * depth / gravity);
    return effective > unhindered ? std::pow(effective / unhindered, -0.38) : 1;
}

}  // namespace wade::crowd
