// Flood walls that water runs over.
#include <omp.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <utility>
#include <vector>

#include "configs/scene/fluid.hpp"
#include "fluid_server/shallow_water/weir_flux.hpp"
#include "tests/validation/site_scenes.hpp"
#include "waters.hpp"

namespace wade::fluid::shallow_water {
namespace weirs_test {

using validation::empty_site;
using validation::house_of;
using validation::Turn;

constexpr double g = 9.81, crest = 0.6, cell = 0.25;

Barrier wall_along(MapLine line, double top) {
    Barrier wall;
    wall.line = std::move(line);
    wall.crest = top;
    return wall;
}

double mean_level(const ShallowWater& world, double x_lo, double x_hi) {
    double sum = 0, cells = 0;
    for_each_cell(world.grid, [&](double x, double, std::size_t c) {
        if (x < x_lo || x > x_hi) return;
        sum += world.water.h[c] + world.bed.height[c], cells += 1;
    });
    return sum / cells;
}

double volume_in(const ShallowWater& world, double x_lo, double x_hi) {
    double sum = 0;
    for_each_cell(world.grid, [&](double x, double, std::size_t c) {
        if (x >= x_lo && x <= x_hi) sum += world.water.h[c] * world.openings.share_of(c);
    });
    return sum * world.grid.cell_area();
}

// A channel of 30 m with a flood wall of 0.6 m in its middle, that a discharge per width, m^2/s, runs over; a level at its end holds
// the water below it, if it is given.
Scene channel_with_a_wall(double discharge, double level_below) {
    Scene scene = empty_site(30, 1, cell);
    Site& site = *scene.site;
    site.roughness.n = 0.01;
    site.barriers = {wall_along({{15, 0}, {15, 1}}, crest)};
    site.water = {{{{{{0, 0}, {15, 0}, {15, 1}, {0, 1}}}}, crest}};
    site.sources.push_back({"river", {{{{0, 0}, {2, 0}, {2, 1}, {0, 1}}}}, {}, {{0, discharge}}, ""});
    Outlet outlet;
    outlet.line = {{30, 0}, {30, 1}};
    if (level_below > 0) {
        outlet.kind = OutletKind::stage;
        outlet.stage = {{0, level_below}};
        site.water.push_back({{{{{15, 0}, {30, 0}, {30, 1}, {15, 1}}}}, level_below});
    }
    site.outlets = {outlet};
    return scene;
}

TEST_CASE("the discharge of a weir is Rehbock's, less by Villemonte where it is drowned", "[site][weir]") {
    // h 0.2 m over a crest of 0.6 m: C 0.638, (2/3) C sqrt(2 g) h^1.5
    CHECK(weir_discharge(g, 0.2, 0, 0.6) ==
          Approx(2.0 / 3 * (0.611 + 0.08 / 3) * std::sqrt(2 * g) * std::pow(0.2, 1.5)));
    CHECK(weir_discharge(g, 0.2, 0.1, 0.6) ==
          Approx(weir_discharge(g, 0.2, 0, 0.6) * std::pow(1 - std::pow(0.5, 1.5), 0.385)));
    CHECK(weir_discharge(g, 0.2, 0.2, 0.6) == 0);
    CHECK(weir_discharge(g, -0.1, 0, 0.6) == 0);
    CHECK(weir_discharge(g, 1, 0, 0) == Approx(2.0 / 3 * 1.011 * std::sqrt(2 * g)));
}

// 5 % in discharge: what laws of weirs are good to.
TEST_CASE("a river backs up before a flood wall until the weir's law lets it pass", "[site][weir]") {
    for (const double head : {0.1, 0.2, 0.4}) {
        for (const double share : {0.0, 0.5, 0.8}) {
            INFO("head " << head << " m, drowned by " << share);
            const double discharge = weir_discharge(g, head, share * head, crest);
            ShallowWater world(channel_with_a_wall(discharge, share > 0 ? crest + share * head : 0));
            run_until(world, 240);
            const double above = mean_level(world, 10, 13) - crest, below = mean_level(world, 18, 24) - crest;
            const double by_law = weir_discharge(g, above, std::max(0.0, below), crest);
            CHECK(std::abs(by_law / discharge - 1) < 0.05);
            if (share > 0) CHECK(std::abs(below - share * head) < 0.02);
        }
    }
}

// The level before a weir that begins to pass water falls until the wave that runs upstream brings as much, h 2 (c_0 - c) = q.
double discharge_behind_a_wave(double depth) {
    double lo = crest, hi = depth;
    for (int k = 0; k < 60; ++k) {
        const double h = 0.5 * (lo + hi), brought = 2 * h * (std::sqrt(g * depth) - std::sqrt(g * h));
        (brought > weir_discharge(g, h - crest, 0, crest) ? lo : hi) = h;
    }
    return weir_discharge(g, lo - crest, 0, crest);
}

// Its nearest faces are a staircase, 1.37 times as long as the line at 30 degrees. 5 % as above.
TEST_CASE("an oblique flood wall passes what its length does", "[site][weir]") {
    for (const double degrees : {0.0, 30.0, 45.0}) {
        INFO(degrees << " degrees");
        Scene scene = empty_site(80, 80, 0.5);
        Site& site = *scene.site;
        const Turn turn(40, 40, degrees);
        site.houses = {house_of(turn.box(-70, 70, 10, 80)), house_of(turn.box(-70, 70, -80, -10))};
        site.barriers = {wall_along({turn(0, -10), turn(0, 10)}, crest)};
        site.water = {{turn.box(-70, 0, -10, 10), crest + 0.2}};
        ShallowWater world(scene);
        const auto beyond = [&] {
            double sum = 0;
            for_each_cell(world.grid, [&](double x, double z, std::size_t c) {
                if (turn.back(x, z).x > 0.6) sum += world.water.h[c] * world.openings.share_of(c);
            });
            return sum * world.grid.cell_area();
        };
        while (world.time < 1) step(world, 1 - world.time);
        const double before = beyond();
        while (world.time < 4) step(world, 4 - world.time);
        CHECK((beyond() - before) / (3 * 20) == Approx(discharge_behind_a_wave(crest + 0.2)).epsilon(0.05));
    }
}

TEST_CASE("water over a flood wall has the same bits for any number of threads, and if all cells are worked on",
          "[site][weir]") {
    Scene scene = empty_site(60, 60, 0.5);
    const Turn turn(30, 30, 25);
    scene.site->barriers = {wall_along({turn(0, -50), turn(0, 0), turn(8, 50)}, crest)};
    scene.site->water = {{turn.box(-50, -1, -50, 50), 1}};
    const auto run = [&](int threads, bool all) {
        const int before = omp_get_max_threads();
        omp_set_num_threads(threads);
        ShallowWater world(scene);
        for (double left = 3; left > 1e-9; left -= step(world, left).dt) {
            if (all) world.lines.active = Lines(world.grid, true);
        }
        omp_set_num_threads(before);
        return world.water;
    };
    const Water one = run(1, false);
    REQUIRE(one.h[ShallowWater(scene).grid.row(60) + 70] > 0.01);  // beyond the wall
    for (const Water& other : {run(2, false), run(3, false), run(1, true)}) {
        CHECK(other.h == one.h);
        CHECK(other.qx == one.qx);
        CHECK(other.qz == one.qz);
    }
}

TEST_CASE("a flood wall holds water up to its crest, and a lake above it rests", "[site][weir]") {
    const Turn turn(10, 5, 20);
    const auto made = [&](double level_left, double level_right) {
        Scene scene = empty_site(20, 10, cell);
        scene.site->barriers = {wall_along({turn(0, -8), turn(0, 8)}, crest)};
        // Cells at the wall belong to one of its sides, wherever the line lies in them.
        scene.site->water = {{turn.box(-20, -0.5, -20, 20), level_left}};
        if (level_right > 0) scene.site->water.push_back({turn.box(0.5, 20, -20, 20), level_right});
        if (level_left == level_right) scene.site->water = {{{}, level_left}};
        return ShallowWater(scene);
    };
    const auto fastest = [](const ShallowWater& world) {
        double most = 0;
        for_each_cell(world.grid, [&](double, double, std::size_t c) {
            most = std::max({most, std::abs(world.primitive.u[c]), std::abs(world.primitive.v[c])});
        });
        return most;
    };
    // A wave runs to the wall at first, over the half metre that is dry before it.
    ShallowWater held = made(0.25, 0), lake = made(0.9, 0.9), sinks = made(1.2, 0.2);
    const double beyond = volume_in(held, 14, 20), all = volume_in(sinks, 0, 20);
    for (ShallowWater* world : {&held, &lake, &sinks}) run_until(*world, 20);
    CHECK(beyond == 0);
    CHECK(volume_in(held, 14, 20) == 0);
    CHECK(fastest(lake) == 0);
    CHECK(std::abs(volume_in(sinks, 0, 20) / all - 1) < 1e-13);
    // Levels swing about one another, no longer by the law of the weir.
    run_until(sinks, 120);
    CHECK(std::abs(mean_level(sinks, 1, 5) - mean_level(sinks, 15, 19)) < 0.02);
}

}  // namespace weirs_test
}  // namespace wade::fluid::shallow_water
