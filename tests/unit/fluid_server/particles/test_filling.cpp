// Water at t = 0, on a bed of any profile.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "fluid_server/dfsph/fluid_world.hpp"
#include "fluid_server/particles/bed_profile.hpp"
#include "fluid_server/particles/filling.hpp"
#include "lanes_that_see.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;

// A bed of facets: geometry, symmetry of what particles see in it, water at rest over a bump.
namespace bed_profile_test {

namespace {

// A tank of 8 x 0.8 m with a bump of 0.2 m between 2 and 6 m.
Scene bump_tank() {
    Scene scene = test::tank(8, 0.8, 2, 0.1);
    scene.channel->sides = Sides::periodic;
    scene.channel->bed_points = {{2, 0}, {3, 0.15}, {4, 0.2}, {5, 0.15}, {6, 0}};
    return scene;
}

}  // namespace

TEST_CASE("the bed is straight between its points and level beyond them", "[fluid][bed]") {
    const std::vector<BedFacet> bed = bed_facets(bump_tank().channel);
    REQUIRE(bed.size() == 6);
    CHECK(bed_height(bed, -100) == 0);
    CHECK(bed_height(bed, 2.5F) == Approx(0.075));
    CHECK(bed_height(bed, 3.5F) == Approx(0.175));
    CHECK(bed_height(bed, 4) == Approx(0.2));
    CHECK(bed_height(bed, 5.9F) == Approx(0.015));
    CHECK(bed_height(bed, 7) == 0);
    CHECK(bed[0].level());
    CHECK_FALSE(bed[1].level());
    CHECK(bed[1].nx * bed[1].nx + bed[1].ny * bed[1].ny == Approx(1));
    CHECK(bed[1].distance(2.5F, 0.075F) == Approx(0).margin(1e-6));
}

TEST_CASE("two particles see one another in a facet or neither does, at the same distance", "[fluid][bed]") {
    const Scene scene = bump_tank();
    const Solids solids(scene);
    const std::vector<BedFacet> bed = bed_facets(scene.channel);
    std::mt19937 random(5);
    const auto in = [&](float lo, float hi) { return std::uniform_real_distribution<float>(lo, hi)(random); };
    const auto above_bed = [&] {
        const float x = in(1.5F, 6.5F);
        return Vec3{x, bed_height(bed, x) + in(0, 0.2F), in(0.3F, 0.5F)};
    };
    const auto seen_from = [&](const Vec3& a, const Vec3& b) {
        std::vector<float> distances;
        std::vector<Mirror> mirrors;
        solids.mirrors_near({a, a}, {}, mirrors);
        for (const Mirror& mirror : mirrors) {
            const Vec3 image = mirror.reflect(b);
            const float r = std::hypot(a[0] - image[0], a[1] - image[1], a[2] - image[2]);
            if (r < 0.2F && test::lanes_that_see(solids, {&a, 1}, b, mirror, {}) == 1) {
                distances.push_back(r);
            }
        }
        return distances;
    };
    int seen = 0;
    for (int n = 0; n < 20000; ++n) {
        const Vec3 a = above_bed();
        Vec3 b = above_bed();
        b[0] = a[0] + in(-0.2F, 0.2F);
        b[1] = bed_height(bed, b[0]) + in(0, 0.2F);
        const std::vector<float> one = seen_from(a, b);
        const std::vector<float> other = seen_from(b, a);
        REQUIRE(one.size() == other.size());
        REQUIRE(one.size() <= 1);
        if (!one.empty()) {
            REQUIRE(one[0] == Approx(other[0]).margin(1e-5));
            ++seen;
        }
    }
    CHECK(seen > 1000);
}

TEST_CASE("water over a bump stays at rest, above the bed", "[fluid][bed]") {
    Scene scene = bump_tank();
    scene.channel->water_blocks = {{{0, 8}, {0, 0.8}, 0.5}};
    scene.fluid->density_solve.tolerance = 1e-4;
    scene.fluid->divergence_solve.tolerance = 1e-4;
    FluidWorld world(scene);
    const std::vector<BedFacet> bed = bed_facets(scene.channel);
    // Volume: 8 x 0.5 m less the trapezia of the bump, 0.5 m2, times 0.8 m.
    CHECK(static_cast<double>(world.particles().count) * 1e-3 == Approx((8 * 0.5 - 0.5) * 0.8).epsilon(0.001));
    for (int frame = 0; frame < 60; ++frame) {
        double remaining = 1.0 / 30;
        while (remaining > 1e-9) {
            remaining -= world.step(remaining).dt;
        }
    }
    const Particles& p = world.particles();
    double v2 = 0;
    double lowest = 1;
    for (std::size_t i = 0; i < p.count; ++i) {
        v2 += static_cast<double>(p.vx[i] * p.vx[i] + p.vy[i] * p.vy[i] + p.vz[i] * p.vz[i]);
        lowest = std::min(lowest, static_cast<double>(p.y[i] - bed_height(bed, p.x[i])));
    }
    // 3 % of sqrt(g H): what settles from a lattice in steps still moves a little after 2 s.
    CHECK(std::sqrt(v2 / static_cast<double>(p.count)) < 0.03 * std::sqrt(9.81 * 0.5));
    CHECK(lowest > 0.02);
    CHECK(world.position_clamps() == 0);
}

}  // namespace bed_profile_test

namespace filling_test {

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
    scene.channel->flow = Flow::periodic;
    scene.channel->slope = 0.75;  // gravity across the bed is 4/5 of g
    Particles particles(1000);
    fill_scene(particles, scene);
    REQUIRE(particles.count == 16 * 4 * 4);
    for (std::size_t i = 0; i < particles.count; ++i) {
        const double rest = 0.8 * scene.world->gravity * (1 - static_cast<double>(particles.y[i]));
        CHECK(static_cast<double>(particles.pressure[i]) == Approx(rest));
    }
}

TEST_CASE("water is filled round an obstacle and starts without a jolt", "[fluid][filling]") {
    Scene scene;
    scene.channel->x = {0, 10};
    scene.channel->z = {0, 5};
    scene.channel->flow = Flow::recirculating;
    scene.channel->initial_river = InitialRiver::filled;
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

}  // namespace filling_test
