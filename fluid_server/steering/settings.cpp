#include "fluid_server/steering/settings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/steering.hpp"
#include "configs/scene/world.hpp"
#include "fluid_server/particles/filling.hpp"
#include "fluid_server/particles/inflow.hpp"

namespace wade::fluid::steering {

namespace {

// Springs between nearest neighbours of a dense packing have modes of up to sqrt(8 k), k the stiffness over the mass. With the
// pairs 10 % nearer than their radius, as under the weight of the water, sqrt(8 k) = 4.5 sqrt(weight) U / d. A step of
// d / (2.25 sqrt(weight) U) is the limit of stability; cfl is its share.
constexpr double stiffness_speed = 2.25;

// A particle loses speed to at most about this many near neighbours.
constexpr double most_near = 20;

float cosine(double degrees) {
    return degrees >= 180 ? -1.0F : static_cast<float>(std::cos(degrees * std::numbers::pi / 180));
}

double largest_start_velocity(const Scene& scene) {
    double fastest = largest_velocity(scene.channel);
    for (const WaterBlock& block : scene.channel->water_blocks) {
        const auto& v = block.velocity;
        fastest = std::max(fastest, std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
    }
    return fastest;
}

void set_pairs(const Steering& s, Settings& out) {
    const auto metres = [&](double radius) { return static_cast<float>(radius * out.spacing); };
    const auto force = [&](double weight) { return static_cast<float>(weight * out.acceleration); };
    const auto rate = [&](double weight) { return static_cast<float>(weight * out.rate); };
    out.separation_radius = metres(s.separation.radius);
    out.separation = force(s.separation.weight);
    out.cohesion_radius = metres(s.cohesion.radius);
    const bool growing = s.cohesion_form == CohesionForm::growing;
    out.pull = growing ? 0 : force(s.cohesion.weight);
    out.pull_growth = growing ? force(s.cohesion.weight) / (out.cohesion_radius * out.cohesion_radius) : 0;
    out.no_pull_within = s.only_where_needed ? out.separation_radius : 0;
    out.loss_radius = metres(s.loss_radius);
    out.loss = rate(s.loss);
    out.loss_relative = s.loss_form == LossForm::relative ? 1 : 0;
    out.alignment_radius = metres(s.alignment.radius);
    out.alignment = rate(s.alignment.weight);
    out.separation_cos = cosine(s.separation.angle);
    out.cohesion_cos = cosine(s.cohesion.angle);
    out.alignment_cos = cosine(s.alignment.angle);
    const bool all_round = s.separation.angle >= 180 && s.cohesion.angle >= 180;
    out.plain = all_round && s.alignment.weight == 0 && s.classes.empty();
    out.wall_force = s.walls != SteeringWalls::constraint;
    out.wall_constraint = s.walls != SteeringWalls::force;
    out.wall_radius = metres(s.wall_radius);
    out.wall = force(s.wall_weight);
    out.wall_loss = rate(s.wall_loss);
    out.max_acceleration = force(s.max_force);
    out.max_speed = static_cast<float>(s.max_speed * out.speed);
}

}  // namespace

Settings make_settings(const Scene& scene) {
    const Steering& s = scene.fluid->steering;
    Settings out;
    const double v = largest_start_velocity(scene);
    out.spacing = scene.fluid->particle_spacing;
    out.speed = std::sqrt(scene.world->gravity * deepest_water(scene) + v * v);
    out.acceleration = out.speed * out.speed / out.spacing;
    out.rate = out.speed / out.spacing;
    set_pairs(s, out);

    double lightest = 1;
    double widest = 1;
    for (const SteeringClass& c : s.classes) {
        lightest = std::min(lightest, c.mass);
        widest = std::max(widest, c.radius);
    }
    out.reach = s.separation.radius * widest;
    if (s.cohesion.weight > 0) out.reach = std::max(out.reach, s.cohesion.radius);
    if (s.loss > 0) out.reach = std::max(out.reach, s.loss_radius);
    if (s.alignment.weight > 0) out.reach = std::max(out.reach, s.alignment.radius);
    out.reach *= out.spacing;

    const double stiffest = std::max(s.separation.weight, out.wall_force ? s.wall_weight : 0);
    out.wave_speed = stiffness_speed * std::sqrt(stiffest / lightest) * out.speed;
    const double losses = (most_near * s.loss + s.wall_loss + s.alignment.weight) * out.rate / lightest;
    out.loss_limit = losses > 0 ? 1 / losses : std::numeric_limits<double>::infinity();
    return out;
}

}  // namespace wade::fluid::steering
