#include "fluid_server/steering/bodies.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "configs/scene/fluid.hpp"
#include "configs/scene/steering.hpp"

namespace wade::fluid::steering {

std::vector<Body> make_bodies(const Scene& scene, const Settings& settings) {
    std::vector<Body> bodies;
    for (const SteeringBody& b : scene.fluid->steering.bodies) {
        Body body;
        body.radius = b.radius;
        body.time = b.time;
        body.vehicle.mass = b.density * 4 / 3 * std::numbers::pi * b.radius * b.radius * b.radius;
        body.vehicle.position = b.place;
        body.vehicle.velocity = b.velocity;
        // What the water does to it is no steering, which alone has a largest force.
        body.vehicle.max_force = std::numeric_limits<double>::infinity();
        const double start = behaviours::length(b.velocity);
        body.vehicle.max_speed = std::max(static_cast<double>(settings.max_speed), 2 * start);
        bodies.push_back(body);
    }
    return bodies;
}

void push_away(const Body& body, const Settings& s, const Vec3& x, float dt, double mass, float mass_factor, Vec3& v,
               Momentum& reaction) {
    Vec3 normal{};
    float squares = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        normal[k] = x[k] - static_cast<float>(body.vehicle.position[k]);
        squares += normal[k] * normal[k];
    }
    const auto radius = static_cast<float>(body.radius);
    const float fastest = s.max_speed + static_cast<float>(body.vehicle.max_speed);
    const float reach = radius + s.wall_radius + dt * fastest;
    if (!(squares < reach * reach) || squares == 0) return;
    const float distance = std::sqrt(squares);
    const float gap = distance - radius;
    float approach = 0;  // negative: nearer
    for (std::size_t k = 0; k < 3; ++k) {
        normal[k] /= distance;
        approach += normal[k] * (v[k] - static_cast<float>(body.vehicle.velocity[k]));
    }
    float change = dt * s.wall * push(s.wall_radius, std::max(gap, 0.0F)) / mass_factor;
    // A particle that would be inside after the step approaches at most at the speed that brings it to the surface.
    change = std::max(change, -std::max(gap, 0.0F) / dt - approach);
    if (!(change > 0)) return;
    for (std::size_t k = 0; k < 3; ++k) {
        v[k] += change * normal[k];
        reaction[k] -= mass * static_cast<double>(change * normal[k]);
    }
}

}  // namespace wade::fluid::steering
