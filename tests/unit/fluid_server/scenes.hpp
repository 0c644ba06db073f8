#pragma once
// Small scenes for the tests of the fluid.

#include "configs/scene/scene.hpp"

namespace wade::fluid::test {

inline Fluid fluid_of(double spacing, int capacity) {
    Fluid fluid;
    fluid.particle_spacing = spacing;
    fluid.max_particles = capacity;
    fluid.kinematic_viscosity = 0.01;
    fluid.cfl = 0.4;
    fluid.density_solve = {5e-4, 2, 100};
    fluid.divergence_solve = {1e-3, 1, 100};
    return fluid;
}

// A closed tank, filled to `depth`.
inline Scene tank(double length, double width, double depth, double spacing) {
    Scene scene;
    scene.channel.x = {0, length};
    scene.channel.z = {0, width};
    scene.channel.flow = Flow::closed;
    scene.channel.water_blocks = {{{0, length}, {0, width}, depth}};
    scene.fluid = fluid_of(spacing, 20000);
    return scene;
}

// A channel with an emitter, initially dry, narrow and short enough for a unit test.
inline Scene emitter_channel(double velocity, double gravity, int capacity) {
    Scene scene;
    scene.world.gravity = gravity;
    scene.channel.x = {0, 10};
    scene.channel.z = {0, 4};
    scene.channel.flow = Flow::emitter;
    scene.channel.depth = 1;
    scene.channel.velocity = velocity;
    scene.fluid = fluid_of(0.4642, capacity);
    return scene;
}

}  // namespace wade::fluid::test
