#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <stdexcept>

#include "fluid_server/dfsph/fluid_world.hpp"
#include "fluid_server/particles/filling.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;

TEST_CASE("a block is filled with the mass of its water to within half a particle", "[fluid][filling]") {
    for (const double spacing : {0.4642, 0.5, 0.25, 0.3137}) {
        Particles particles(400000);
        fill_block(particles, {{0, 100}, {11.5, 38.5}, 1, 0, {-1.5, 0, 0}}, {spacing});
        const double volume = static_cast<double>(particles.count) * std::pow(spacing, 3);
        CHECK(std::abs(volume - 2700) <= 0.5 * std::pow(spacing, 3) + 1e-9);
    }
}

TEST_CASE("narrow, tall and tiny blocks get their mass as well", "[fluid][filling]") {
    struct Case {
        double length, depth, width, spacing;
    };
    for (const Case& c : {Case{10, 10, 0.75, 0.5}, Case{20, 1, 0.25, 0.1}, Case{1.5, 1.5, 1.5, 1},
                          Case{0.15, 1, 0.25, 0.1}, Case{1, 8, 1, 0.3}, Case{100, 5, 0.7, 0.4642}}) {
        Particles particles(100000);
        fill_block(particles, {{0, c.length}, {0, c.width}, c.depth}, {c.spacing});
        CHECK(particles.count ==
              static_cast<std::size_t>(std::llround(c.length * c.depth * c.width / std::pow(c.spacing, 3))));
    }
}

TEST_CASE("more particles than the capacity are refused", "[fluid][filling]") {
    Particles particles(10);
    CHECK_THROWS_AS(fill_block(particles, {{0, 10}, {0, 1}, 1}, {0.25}), std::length_error);
    CHECK(particles.count == 10);
}

TEST_CASE("a filled block keeps within its bounds and moves as asked", "[fluid][filling]") {
    Particles particles(5000);
    fill_block(particles, {{2, 5}, {-1, 1}, 1, 0, {-2.5, 0, 0}}, {0.23});
    REQUIRE(particles.count > 0);
    bool inside = true;
    for (std::size_t i = 0; i < particles.count; ++i) {
        inside = inside && particles.x[i] > 2 && particles.x[i] < 5 && particles.y[i] > 0 && particles.y[i] < 1.12F &&
                 particles.z[i] > -1 && particles.z[i] < 1 && particles.vx[i] == -2.5F;
    }
    CHECK(inside);  // the uppermost, incomplete layer stands out by half a spacing at most
}

TEST_CASE("a block whose sides are multiples of the spacing becomes a perfect cubic lattice", "[fluid][filling]") {
    Particles particles(400);
    fill_block(particles, {{0, 2}, {0, 1}, 0.75}, {0.25});
    REQUIRE(particles.count == 8 * 3 * 4);
    for (std::size_t i = 0; i < particles.count; ++i) {
        for (const float x : {particles.x[i], particles.y[i], particles.z[i]}) {
            CHECK(std::fmod(x, 0.25F) == 0.125F);
        }
    }
}

TEST_CASE("water on a slope starts with the pressure of the gravity across the bed", "[fluid][filling]") {
    Scene scene = test::tank(4, 1, 1, 0.25);
    scene.channel.flow = Flow::periodic;
    scene.channel.slope = 0.75;  // gravity across the bed is 4/5 of g
    Particles particles(1000);
    fill_scene(particles, scene);
    REQUIRE(particles.count == 16 * 4 * 4);
    for (std::size_t i = 0; i < particles.count; ++i) {
        const double rest = 0.8 * scene.world.gravity * (1 - static_cast<double>(particles.y[i]));
        CHECK(static_cast<double>(particles.pressure[i]) == Approx(rest));
    }
}

TEST_CASE("water is filled round an obstacle and starts without a jolt", "[fluid][filling]") {
    Scene scene;
    scene.channel.x = {0, 10};
    scene.channel.z = {0, 5};
    scene.channel.flow = Flow::recirculating;
    scene.channel.initial_river = InitialRiver::filled;
    scene.obstacles = {{{3.1, 5.02}, {1.93, 3.3}, 2}};  // faces that no lattice meets
    scene.fluid = test::fluid_of(0.25, 4000);
    FluidWorld world(scene);
    double fastest = 0;
    for (int n = 0; n < 60; ++n) {
        world.step(1.0 / 60);
        const Particles& p = world.particles();
        for (std::size_t i = 0; i < p.count; ++i) {
            fastest = std::max(fastest, std::hypot(static_cast<double>(p.vx[i]), static_cast<double>(p.vy[i]),
                                                   static_cast<double>(p.vz[i])));
        }
    }
    // Gaps beside the faces close under the pressure of 1 m of water, by Bernoulli at sqrt(2 g H) = 4.4 m/s at most; a
    // particle that started inside a face would be shot away at d / 2 dt = 7.5 m/s or more.
    CHECK(fastest < std::sqrt(2 * 9.81 * 1));
    CHECK(world.position_clamps() == 0);
    // Free volume 10 x 5 - 1.92 x 1.37 m2, less the gaps of the lattice: half a spacing round the obstacle at most.
    const double free_volume = 50 - 1.92 * 1.37;
    const double filled = static_cast<double>(world.particles().count) * std::pow(0.25, 3);
    CHECK(filled <= free_volume + 1.92 * 0.25);
    CHECK(filled >= free_volume - 0.125 * 2 * (1.92 + 1.37) - 0.5);
}
