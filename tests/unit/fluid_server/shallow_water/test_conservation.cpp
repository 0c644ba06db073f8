// What the grid keeps to rounding: level water, mass, symmetry, the same bits for any number of threads.

#include <omp.h>

#include <algorithm>
#include <catch2/catch.hpp>

#include "configs/scene/channel.hpp"
#include "waters.hpp"

using namespace wade;
using namespace wade::fluid::shallow_water;

namespace {

// Largest distance of the surface from a height in wet cells, m, and largest speed, m/s.
struct Unrest {
    double surface = 0, speed = 0;
};
Unrest unrest(const ShallowWater& world, double height) {
    Unrest most;
    for_each_cell(world.grid, [&](double, double, std::size_t c) {
        if (world.water.h[c] <= world.constants.dry) return;
        most.surface = std::max(most.surface, std::abs(world.primitive.surface()[c] - height));
        most.speed = std::max(most.speed, std::hypot(world.primitive.u[c], world.primitive.v[c]));
    });
    return most;
}

Scene uneven_lake() {
    Scene scene = basin(20, 6, 0.5);
    // A shore on either side, a bar under water, slopes of all sizes.
    scene.channel->bed_points = {{0, 1.4}, {3.3, 0.2}, {6, 0}, {8, 0.7}, {9.1, 0.65}, {11, 0.05}, {16, 0.3}, {20, 1.7}};
    scene.channel->water_blocks = {{{0, 20}, {0, 6}, 1.0}};
    return scene;
}

}  // namespace

TEST_CASE("a lake over an uneven bed with shores stays at rest to rounding", "[shallow_water]") {
    ShallowWater world(uneven_lake());
    run_until(world, 20);
    const Unrest after = unrest(world, 1.0);
    CHECK(after.surface <= 1e-12);
    CHECK(after.speed <= 1e-12);
}

TEST_CASE("a lake round a box that stands out of it and over one that does not stays at rest", "[shallow_water]") {
    Scene scene = uneven_lake();
    scene.obstacles = {{{5, 6.5}, {2, 4}, 2.0}, {{12, 14}, {1, 3.5}, 0.6}, {{15, 16}, {3, 4.5}, 1.0}};
    ShallowWater world(scene);
    run_until(world, 20);
    const Unrest after = unrest(world, 1.0);
    CHECK(after.surface <= 1e-12);
    CHECK(after.speed <= 1e-12);
}

TEST_CASE("water below the top of a box does not pass it", "[shallow_water]") {
    Scene scene = basin(12, 2, 0.5);
    scene.obstacles = {{{5, 6}, {0, 2}, 3.0}};  // from bank to bank
    scene.channel->water_blocks = {{{8, 12}, {0, 2}, 1.0}};
    ShallowWater world(scene);
    const double before = volume(world);
    run_until(world, 5);
    double beyond = 0, speed = 0;
    for_each_cell(world.grid, [&](double x, double, std::size_t c) {
        if (x < 6) beyond += world.water.h[c];
        speed = std::max(speed, std::abs(world.primitive.u[c]));
    });
    CHECK(beyond == 0);
    CHECK(speed > 0.1);
    CHECK(volume(world) == Approx(before).epsilon(1e-13));
}

TEST_CASE("a stream against a box rises as before a wall", "[shallow_water]") {
    // A stream of Froude number 2 is reflected; the bore that runs back has the depth of a wall's, by the jump's equations.
    const auto rise = [](bool box) {
        Scene scene = basin(box ? 24 : 20, 0.1, 0.1);
        if (box) scene.obstacles = {{{0, 4}, {0, 0.1}, 5.0}};
        ShallowWater world(scene);
        const double wall = box ? 4 : 0;
        set_water(
            world, [&](double x, double) { return x < wall ? 0.0 : 0.5; }, [](double, double) { return -4.4; },
            [](double, double) { return 0.0; });
        run_until(world, 1);
        double depth = 0;
        for_each_cell(world.grid, [&](double x, double, std::size_t c) {
            if (x > wall && x < wall + 0.5) depth += world.water.h[c] / 5;
        });
        return depth;
    };
    CHECK(rise(true) == Approx(rise(false)).epsilon(0.01));
    // (h2 - h1) (h2^2 - h1^2) g / 2 = h1 h2 u1^2
    const double h1 = 0.5, u1 = 4.4, h2 = rise(false);
    CHECK((h2 - h1) * (h2 * h2 - h1 * h1) * 9.81 / 2 == Approx(h1 * h2 * u1 * u1).epsilon(0.02));
}

TEST_CASE("a closed and a periodic channel keep their mass to rounding", "[shallow_water]") {
    Scene closed = uneven_lake();
    closed.obstacles = {{{12, 14}, {1, 3.5}, 0.6}};
    closed.channel->water_blocks = {{{13, 20}, {1, 5}, 1.5}};
    Scene round = river(20, 6, 0.5, 1, 2);
    round.channel->sides = Sides::periodic;
    round.channel->bed_points = {{3, 0}, {8, 0.5}, {15, 0}};
    for (const Scene& scene : {closed, round}) {
        ShallowWater world(scene);
        const double before = volume(world);
        run_until(world, 10);
        CHECK(std::abs(volume(world) / before - 1) <= 1e-13);
    }
}

TEST_CASE("what the emitter brings and the fall takes closes the budget of mass", "[shallow_water]") {
    Scene scene = basin(20, 4, 0.5);
    scene.channel->flow = Flow::emitter;
    scene.channel->depth = 1, scene.channel->velocity = 1.5;
    scene.channel->velocity_history = {{0, 0}, {3, 2}, {6, 5}, {7, 5}, {7, 1}};
    ShallowWater world(scene);
    double in = 0, out = 0;
    for (double left = 20; left > 1e-9;) {
        const StepReport report = step(world, std::min(left, 1.0 / 30));
        left -= report.dt, in += report.inflow, out += report.outflow;
    }
    // The integral of v_F times depth and width: 3 + 10.5 + 5 + 13 m.
    CHECK(in == Approx(31.5 * 4).epsilon(1e-12));
    CHECK(out > 60);
    CHECK(volume(world) == Approx(in - out).epsilon(1e-12));
}

TEST_CASE("a flow with a mirror plane stays its own mirror image", "[shallow_water]") {
    Scene scene = basin(15, 8, 0.5);
    scene.obstacles = {{{6, 7}, {3, 5}, 2.0}};
    scene.channel->water_blocks = {{{10, 15}, {0, 8}, 1.0}};
    ShallowWater world(scene);
    run_until(world, 6);
    double worst = 0;
    for (std::size_t k = 0; k < world.grid.nz; ++k) {
        const std::size_t a = world.grid.row(static_cast<std::ptrdiff_t>(k));
        const std::size_t b = world.grid.row(static_cast<std::ptrdiff_t>(world.grid.nz - 1 - k));
        for (std::size_t i = 0; i < world.grid.nx; ++i) {
            worst = std::max(worst, std::abs(world.water.h[a + i] - world.water.h[b + i]));
            worst = std::max(worst, std::abs(world.water.qz[a + i] + world.water.qz[b + i]));
        }
    }
    CHECK(worst == 0);
}

TEST_CASE("the same flow along x and across is the same", "[shallow_water]") {
    Scene along = basin(20, 4, 0.5), across = basin(4, 20, 0.5);
    along.channel->water_blocks = {{{12, 20}, {0, 4}, 1.0}};
    across.channel->water_blocks = {{{0, 4}, {12, 20}, 1.0}};
    ShallowWater a(along), b(across);
    run_until(a, 3), run_until(b, 3);
    double worst = 0;
    for (std::size_t i = 0; i < 40; ++i) {
        worst = std::max(
            worst, std::abs(a.water.h[a.grid.row(3) + i] - b.water.h[b.grid.row(static_cast<std::ptrdiff_t>(i)) + 3]));
    }
    CHECK(worst <= 1e-12);
}

TEST_CASE("shallow water has the same bits for any number of threads", "[shallow_water]") {
    Scene scene = basin(50, 45, 0.5);  // 9000 cells
    scene.obstacles = {{{20, 25}, {20, 26}, 2.0}, {{10, 12}, {5, 9}, 0.2}};
    scene.channel->water_blocks = {{{30, 50}, {0, 45}, 1.0}};
    scene.channel->manning_n = 0.03;
    const int before = omp_get_max_threads();
    std::vector<Water> results;
    for (const int threads : {1, 2, 3}) {
        omp_set_num_threads(threads);
        ShallowWater world(scene);
        run_until(world, 1.5);
        results.push_back(world.water);
    }
    omp_set_num_threads(before);
    for (const Water& other : results) {
        CHECK(other.h == results.front().h);
        CHECK(other.qx == results.front().qx);
        CHECK(other.qz == results.front().qz);
    }
}

TEST_CASE("depths stay positive and finite where water meets dry slopes and steps", "[shallow_water]") {
    Scene scene = uneven_lake();
    scene.obstacles = {{{8, 9}, {1, 3}, 1.2}, {{12, 14}, {1, 3.5}, 0.4}};
    scene.channel->water_blocks = {{{14, 20}, {0, 3}, 4.0, 0, {-6, 0, 2}}};
    ShallowWater world(scene);
    const double before = volume(world);
    double least = 1, fastest = 0;
    while (world.time < 15) {
        step(world, 0.1);
        for_each_cell(world.grid, [&](double, double, std::size_t c) {
            least = std::min(least, world.water.h[c]);
            fastest = std::max(fastest, std::abs(world.primitive.u[c]));
        });
    }
    CHECK(least >= 0);
    CHECK(fastest < 40);  // 2 sqrt(g 4 m) + 6 m/s = 18.5 m/s
    CHECK(std::abs(volume(world) / before - 1) <= 1e-13);
}
