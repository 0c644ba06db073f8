// A bed of facets: geometry, symmetry of what particles see in it, water at rest over a bump.

#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "fluid_server/dfsph/fluid_world.hpp"
#include "fluid_server/particles/bed_profile.hpp"
#include "lanes_that_see.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;

namespace {

// A tank of 8 x 0.8 m with a bump of 0.2 m between 2 and 6 m.
Scene bump_tank() {
    Scene scene = test::tank(8, 0.8, 2, 0.1);
    scene.channel.sides = Sides::periodic;
    scene.channel.bed_points = {{2, 0}, {3, 0.15}, {4, 0.2}, {5, 0.15}, {6, 0}};
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
    scene.channel.water_blocks = {{{0, 8}, {0, 0.8}, 0.5}};
    scene.fluid.density_solve.tolerance = 1e-4;
    scene.fluid.divergence_solve.tolerance = 1e-4;
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
