#pragma once
// A few particles in open space and what they feel of one another.

#include <array>
#include <vector>

#include "../scenes.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "fluid_server/steering/steering_world.hpp"

namespace wade::fluid::test {

struct Vehicles {
    std::vector<Vec3> place, velocity;
    std::vector<float> radius{}, mass{};  // factors; empty: 1
};

// Settings of lengths in m without scales: nothing acts.
inline steering::Settings quiet_settings() {
    steering::Settings s;
    s.spacing = 1;
    s.separation_radius = 1;
    s.cohesion_radius = 2;
    s.loss_radius = 1.5F;
    s.alignment_radius = 2;
    s.wall_radius = 0.5F;
    s.max_acceleration = 1e6F;
    s.max_speed = 1e6F;
    s.reach = 2;
    return s;
}

inline std::vector<Vec3> accelerations(const Vehicles& vehicles, const steering::Settings& settings) {
    Scene scene = tank(20, 20, 1, 1);
    scene.channel->sides = Sides::periodic;
    scene.channel->top = Top::periodic;
    scene.channel->height = 20;
    scene.channel->flow = Flow::periodic;
    Particles p(100);
    scene.fluid->max_particles = 100;
    for (std::size_t i = 0; i < vehicles.place.size(); ++i) p.add(vehicles.place[i], vehicles.velocity[i], Kind::fluid);
    for (std::size_t i = 0; i < p.count; ++i) {
        steering::radius_factors(p)[i] = vehicles.radius.empty() ? 1 : vehicles.radius[i];
        steering::mass_factors(p)[i] = vehicles.mass.empty() ? 1 : vehicles.mass[i];
    }
    // Few particles: unsorted they are all in one cluster, and the search goes over the whole grid.
    const auto reach = static_cast<float>(settings.reach);
    CellGrid grid(scene, reach);
    std::vector<Vec3> before(p.count);
    for (std::size_t i = 0; i < p.count; ++i) {
        p.kind[i] = Kind::fluid;
        before[i] = {p.x[i], p.y[i], p.z[i]};
    }
    grid.sort(p, -Box::inf);
    NeighbourLists lists(p.capacity());
    find_neighbours(grid, Solids(scene), p, reach, lists);
    std::vector<float> x(padded(100)), y(padded(100)), z(padded(100));
    steering::sum_flock(0, p, lists, settings, {x.data(), y.data(), z.data()});
    // In the order of the input.
    std::vector<Vec3> result(p.count);
    for (std::size_t i = 0; i < p.count; ++i) {
        for (std::size_t k = 0; k < p.count; ++k) {
            if (before[k] == Vec3{p.x[i], p.y[i], p.z[i]}) result[k] = {x[i], y[i], z[i]};
        }
    }
    return result;
}

// A tank of steering water with the weights of the schema, and some cohesion.
inline Scene steering_tank(double length, double width, double depth, double spacing) {
    Scene scene = tank(length, width, depth, spacing);
    scene.fluid->model = wade::ModelKind::steering;
    scene.fluid->cfl = 0.5;
    wade::Steering& s = scene.fluid->steering;
    s.separation = {1.12, 180, 4};
    s.alignment = {2, 180, 0};
    s.cohesion = {2, 180, 0.002};
    s.loss = 0.1, s.loss_radius = 1.5;
    s.wall_radius = 0.6, s.wall_weight = 4, s.wall_loss = 0.02;
    s.max_force = 20, s.max_speed = 4;
    return scene;
}

}  // namespace wade::fluid::test
