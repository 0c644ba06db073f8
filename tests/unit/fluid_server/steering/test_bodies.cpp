#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "flock_pair.hpp"
#include "fluid_server/steering/bodies.hpp"

using namespace wade;
using namespace wade::fluid;
using namespace wade::fluid::test;

namespace {

// A tank with a sphere over it.
Scene tank_with_sphere(double density) {
    Scene scene = steering_tank(0.8, 0.8, 0.6, 0.08);
    scene.fluid->steering.bodies = {{{0.4, 0.9, 0.4}, {0, 0, 0}, 0.5, 0.15, density}};
    return scene;
}

double height_after(steering::SteeringWorld& world, double time) {
    for (int k = 0; k < static_cast<int>(time * 30 + 0.5); ++k) {
        for (double left = 1.0 / 30; left > 1e-9;) left -= world.step(left).dt;
    }
    return world.bodies()[0].vehicle.position[1];
}

}  // namespace

TEST_CASE("a sphere pushes a particle along the line from its centre and gets the opposite momentum", "[steering]") {
    steering::Settings s = quiet_settings();
    s.wall = 3;
    steering::Body body;
    body.radius = 1;
    body.vehicle.position = {5, 5, 5};
    Vec3 v{0, 0, 0};
    steering::Momentum reaction{};
    push_away(body, s, {6.4F, 5, 5}, 0.01F, 2, 1, v, reaction);
    const double change = 0.01 * 3 * (0.25 / 0.16 - 1);
    CHECK(static_cast<double>(v[0]) == Approx(change).epsilon(1e-3));
    CHECK(reaction[0] == Approx(-2 * change).epsilon(1e-3));
    // One that would be inside after the step gets no further than to the surface.
    v = {-100, 0, 0};
    push_away(body, s, {6.4F, 5, 5}, 0.01F, 2, 1, v, reaction);
    CHECK(static_cast<double>(v[0]) == Approx(-40).epsilon(1e-3));
    v = {1, 2, 3};
    push_away(body, s, {7, 5, 5}, 0.01F, 2, 1, v, reaction);
    CHECK(v == Vec3{1, 2, 3});
}

TEST_CASE("a heavy sphere sinks, a light one floats, and the water closes over the heavy one", "[steering]") {
    steering::SteeringWorld heavy(tank_with_sphere(5000));
    const double before = height_after(heavy, 0.4);
    CHECK(before == 0.9);  // it has not appeared yet
    const double sunk = height_after(heavy, 4);
    CHECK(sunk < 0.25);
    CHECK(sunk >= 0.15 - 1e-6);
    int above = 0;
    for (std::size_t i = 0; i < heavy.particles().count; ++i) {
        const Vec3 x = heavy.place(i);
        const auto dx = static_cast<double>(x[0]) - 0.4, dz = static_cast<double>(x[2]) - 0.4;
        above += dx * dx + dz * dz < 0.15 * 0.15 && static_cast<double>(x[1]) > sunk + 0.15 ? 1 : 0;
    }
    CHECK(above > 10);
    steering::SteeringWorld light(tank_with_sphere(200));
    const double floating = height_after(light, 4.5);
    CHECK(floating > 0.5);
    CHECK(floating < 0.8);
}

TEST_CASE("a sphere on a periodic border displaces water on both sides of it", "[steering]") {
    Scene scene = steering_tank(0.9, 0.8, 0.6, 0.1);
    scene.channel->flow = Flow::periodic;
    scene.fluid->steering.bodies = {{{0.15, 0.3, 0.4}, {-0.5, 0, 0}, 0, 0.15, 1000}};
    steering::SteeringWorld world(scene);
    for (int k = 0; k < 30; ++k) {
        for (double left = 1.0 / 30; left > 1e-9;) left -= world.step(left).dt;
        const auto& centre = world.bodies()[0].vehicle.position;
        for (std::size_t i = 0; i < world.particles().count; ++i) {
            const Vec3 x = world.place(i);
            double dx = static_cast<double>(x[0]) - centre[0];
            dx -= 0.9 * std::round(dx / 0.9);
            const double dy = static_cast<double>(x[1]) - centre[1], dz = static_cast<double>(x[2]) - centre[2];
            // Those that it starts upon leave within the first steps.
            if (k > 10) CHECK(dx * dx + dy * dy + dz * dz > 0.13 * 0.13);
        }
    }
}
