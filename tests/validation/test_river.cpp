// The recirculating river: it holds its mass, its depth and its speed, everywhere where agents walk.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <iostream>
#include <vector>

#include "run_frames.hpp"

using namespace wade;
using namespace wade::fluid;

namespace {

// What the river must hold, averaged over the last `averaged` seconds.
struct River {
    double areal_mass = 0;     // kg/m2
    double depth = 0;          // m, twice the mean height
    double bulk_speed = 0;     // m/s, worst deviation of all frames from v_F as a fraction
    double worst_tile = 0;     // largest deviation of a tile's mean speed from v_F, as a fraction
    double driving = 0;        // m/s2, mean
    double density_error = 0;  // max
};

River run_river(const Scene& scene, double averaged) {
    FluidWorld world(scene);
    const Channel& channel = scene.channel;
    // Tiles of 10 m x 3 m over the channel, the whole region where agents cross.
    const auto nx = static_cast<std::size_t>(std::max(1L, std::lround(channel.x.length() / 10)));
    const auto nz = static_cast<std::size_t>(std::max(1L, std::lround(channel.z.length() / 3)));
    std::vector<double> momentum(nx * nz, 0);
    std::vector<double> count(nx * nz, 0);
    River river;
    const int frames = static_cast<int>(std::lround(scene.duration * scene.frame_rate));
    const int last = static_cast<int>(std::lround(averaged * scene.frame_rate));
    double steps = 0;
    for (int f = 1; f <= frames; ++f) {
        test::advance_one_frame(world, [&](const StepReport& step) {
            river.density_error = std::max(river.density_error, step.max_density_error);
            river.driving += step.driving_acceleration;
            ++steps;
        });
        const Particles& p = world.particles();
        double bulk = 0;
        for (std::size_t i = 0; i < p.count; ++i) {
            bulk -= static_cast<double>(p.vx[i]) / static_cast<double>(p.count);
        }
        river.bulk_speed = std::max(river.bulk_speed, std::abs(bulk / channel.velocity - 1));
        if (f <= frames - last) {
            continue;
        }
        for (std::size_t i = 0; i < p.count; ++i) {
            const auto along = [](double v, const Interval& span, std::size_t n) {
                return std::min(static_cast<std::size_t>((v - span.lo) / span.length() * static_cast<double>(n)),
                                n - 1);
            };
            const std::size_t tile = along(static_cast<double>(p.z[i]), channel.z, nz) * nx +
                                     along(static_cast<double>(p.x[i]), channel.x, nx);
            momentum[tile] -= static_cast<double>(p.vx[i]);
            count[tile] += 1;
            river.depth += 2 * static_cast<double>(p.y[i]) / static_cast<double>(p.count) / last;
        }
    }
    for (std::size_t tile = 0; tile < count.size(); ++tile) {
        river.worst_tile = std::max(river.worst_tile, std::abs(momentum[tile] / count[tile] / channel.velocity - 1));
    }
    river.driving /= steps;
    river.areal_mass = static_cast<double>(world.particles().count) * static_cast<double>(world.particle_mass()) /
                       (channel.x.length() * channel.z.length());
    REQUIRE(world.position_clamps() == 0);
    std::cout << "river " << scene.name << ", d = " << scene.fluid.particle_spacing << " m, " << channel.x.length()
              << " m long, " << scene.duration << " s, " << world.particles().count << " particles: areal mass "
              << river.areal_mass << " kg/m2, depth " << river.depth << " m, bulk speed within "
              << 100 * river.bulk_speed << " %, worst tile " << 100 * river.worst_tile << " %, driving acceleration "
              << river.driving << " m/s2, max density error " << 100 * river.density_error << " %" << std::endl;
    return river;
}

// The limits are those that a reader of "1 m deep, v_F" would grant; the depth is asked of four layers and more, as two
// layers of particles cannot resolve a free surface better than a tenth of a spacing.
void check(const River& river, bool check_depth) {
    CHECK(river.areal_mass == Approx(1000).epsilon(0.001));
    CHECK(river.bulk_speed <= 0.005);
    CHECK(river.worst_tile <= 0.05);
    if (check_depth) {
        CHECK(river.depth == Approx(1).epsilon(0.02));
    }
}

Scene river_scene(const std::string& name, double spacing, double length, double duration) {
    Scene scene = test::shipped_scene("river/" + name);
    scene.fluid.particle_spacing = spacing;
    scene.fluid.max_particles = 200000;
    scene.channel.x = {0, length};
    scene.duration = duration;
    return scene;
}

}  // namespace

TEST_CASE("a short piece of the river holds mass, depth and speed", "[validation][river]") {
    check(run_river(river_scene("s05.json", 0.25, 10, 20), 5), true);
    check(run_river(river_scene("s06.json", 0.4642, 20, 60), 10), false);
}

// The channel is periodic: 10 m of it are as good as 100 m, so the fine river is that long.
TEST_CASE("the river of the paper's size at 0.5 m/s holds mass and speed for 300 s", "[.long][river_default]") {
    check(run_river(river_scene("s04.json", 0.4642, 100, 300), 30), false);
}

TEST_CASE("the river of the paper's size at 1.5 m/s holds mass and speed for 300 s", "[.long][river_default]") {
    check(run_river(river_scene("s05.json", 0.4642, 100, 300), 30), false);
}

TEST_CASE("the river of the paper's size at 2.5 m/s holds mass and speed for 300 s", "[.long][river_default]") {
    check(run_river(river_scene("s06.json", 0.4642, 100, 300), 30), false);
}

TEST_CASE("the river at 0.25 m spacing holds mass, depth and speed for 300 s", "[.long][river_fine]") {
    check(run_river(river_scene("s05.json", 0.25, 10, 300), 30), true);
}
