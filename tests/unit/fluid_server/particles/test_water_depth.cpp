#include <catch2/catch.hpp>

#include "fluid_server/particles/water_depth.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;

namespace {

constexpr double spacing = 0.05;

// A stream 0.4 m deep in a channel 4 m long and 0.6 m wide.
Scene stream() {
    Scene scene = test::tank(4, 0.6, 0.4, spacing);
    scene.fluid.max_particles = 60000;
    return scene;
}

// Adds a box of water on a lattice, from the bed up.
void add_box(Particles& particles, Interval x, double top, Interval z) {
    for (double a = x.lo + spacing / 2; a < x.hi; a += spacing) {
        for (double y = spacing / 2; y < top; y += spacing) {
            for (double b = z.lo + spacing / 2; b < z.hi; b += spacing) {
                particles.add({static_cast<float>(a), static_cast<float>(y), static_cast<float>(b)}, {0, 0, 0},
                              Kind::fluid, 0);
            }
        }
    }
}

}  // namespace

TEST_CASE("water that stands more than twice as deep as the scene says counts with its depth", "[fluid][depth]") {
    WaterDepth depth(stream());
    Particles particles(60000);
    add_box(particles, {0, 4}, 0.4, {0, 0.6});
    CHECK(depth.now(particles, 0.4) == 0.4);
    Particles jump(60000);
    add_box(jump, {0, 1}, 1.5, {0, 0.6});
    add_box(jump, {1, 4}, 0.4, {0, 0.6});
    CHECK(depth.now(jump, 1.5) == Approx(1.5).epsilon(0.02));  // a column holds whole particles
    // Not yet twice as deep.
    Particles wave(60000);
    add_box(wave, {0, 4}, 0.75, {0, 0.6});
    CHECK(depth.now(wave, 0.75) == 0.4);
}

TEST_CASE("a thin sheet does not count as deep water", "[fluid][depth]") {
    WaterDepth depth(stream());
    Particles particles(60000);
    add_box(particles, {0, 4}, 0.4, {0, 0.6});
    add_box(particles, {0, spacing}, 1.4, {0, 0.6});  // runs up a wall, one particle thick
    CHECK(depth.now(particles, 1.4) == 0.4);
}

TEST_CASE("ten layers and fewer are never measured", "[fluid][depth]") {
    Scene scene = stream();
    scene.channel.water_blocks.at(0).depth = 0.1;
    WaterDepth depth(scene);
    Particles particles(60000);
    add_box(particles, {0, 4}, 0.5, {0, 0.6});  // five times as deep: ten layers
    CHECK(depth.now(particles, 0.5) == 0.1);
}
