// Outlets with a level: `stage`, a large water at rest outside, and `wave`, open water.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "configs/scene/fluid.hpp"
#include "tests/validation/site_scenes.hpp"
#include "waters.hpp"

namespace wade::fluid::shallow_water {
namespace outlets_test {

using validation::empty_site;

constexpr double g = 9.81;

// A basin along x with the outlet at x = 0, walls elsewhere, and standing water.
Scene basin_with(OutletKind kind, Series level, double length, double cell, double standing, double slope = 0) {
    Scene scene = empty_site(length, 4 * cell, cell);
    Site& site = *scene.site;
    site.ground.slope_x = slope;
    site.water = {{{}, standing}};
    site.outlets = {{"sea", kind, {}, {{0, 0}, {0, 4 * cell}}, std::move(level)}};
    return scene;
}

// Basin of 60 m with friction; a wave from end to end takes a minute or so.
Scene harbour(Series level, double standing) {
    Scene scene = basin_with(OutletKind::stage, std::move(level), 60, 1, standing, 0.001);
    scene.site->roughness.n = 0.03;
    return scene;
}

double water_volume(const ShallowWater& world) {
    double sum = 0;
    for_each_cell(world.grid, [&](double, double, std::size_t c) { sum += world.water.h[c]; });
    return sum * world.grid.cell_area();
}

double level_at(const ShallowWater& world, double x) {
    const std::size_t c = world.grid.row(1) + static_cast<std::size_t>(x / world.grid.dx);
    return world.water.h[c] + world.bed.height[c];
}

// Runs until a time and calls look(time) after each step. The volumes that passed must explain the volume that is left.
void run_and_look(ShallowWater& world, double until, const std::function<void(double)>& look) {
    const double at_first = water_volume(world);
    double in = 0, out = 0;
    while (world.time < until - 1e-9) {
        const StepReport report = step(world, std::min(0.5, until - world.time));
        in += report.inflow, out += report.outflow;
        look(world.time);
    }
    CHECK(std::abs(water_volume(world) - at_first - in + out) < 1e-9 * (at_first + in));  // sums of rounding
}

struct Levels {
    double near = -1e9, far = -1e9;  // largest, at 2.5 and 57.5 m
    double mean_near = 0, mean_far = 0;
};
// mean_from, mean_until: the time over which means are taken, s.
Levels levels_of(const Scene& scene, double until, double mean_from = 0, double mean_until = 0) {
    ShallowWater world(scene);
    Levels levels;
    double last = 0;
    run_and_look(world, until, [&](double time) {
        const double near = level_at(world, 2.5), far = level_at(world, 57.5);
        levels.near = std::max(levels.near, near);
        levels.far = std::max(levels.far, far);
        const double within = std::min(time, mean_until) - std::max(last, mean_from);
        if (within > 0) {
            levels.mean_near += near * within / (mean_until - mean_from);
            levels.mean_far += far * within / (mean_until - mean_from);
        }
        last = time;
    });
    return levels;
}

// Falls below the bed (lowest height 0) within 40 s and comes back.
Series dip_to(double lowest) {
    return {{0, 1}, {20, 1}, {60, lowest}, {200, lowest}, {240, 1}, {400, 1}};
}
const Series surge{{0, 0.2}, {100, 0.2}, {160, 3}, {400, 3}};

// Period of the seiche of the basin, a quarter wave long, s.
double seiche(double depth) {
    return 4 * 60 / std::sqrt(g * depth);
}

}  // namespace outlets_test

// A basin of 60 m, 2 m deep: a wave from the mouth is reflected by the wall, and by the mouth with the opposite sign. The mouth is
// the inner face of the cells of the outlet.
TEST_CASE("the level at a stage is followed like linear theory has it", "[site]") {
    using namespace outlets_test;
    constexpr double cell = 1, length = 60 - cell, depth = 2, rise = 0.02;
    const double c = std::sqrt(g * depth);
    const auto compare = [&](const Series& series, double until) {
        const auto change = [&](double time) { return value_at(series, time) - depth; };
        const auto exact = [&](double x, double time) {
            double sum = 0;
            for (int k = 0; k < 30; ++k) {
                const double sign = k % 2 == 0 ? 1 : -1;
                sum += sign * (change(time - (2 * k * length + x) / c) + change(time - (2 * (k + 1) * length - x) / c));
            }
            return sum;
        };
        ShallowWater world(basin_with(OutletKind::stage, series, length + cell, cell, depth));
        double worst = 0;
        run_and_look(world, until, [&](double time) {
            for (const double x : {2.5, 58.5})
                worst = std::max(worst, std::abs(level_at(world, x) - depth - exact(x - cell, time)));
        });
        return worst;
    };
    // A tenth of the rise: kinks of the series are rounded over some cells of 60.
    CHECK(compare({{0, depth}, {20, depth + rise}}, 45) < 0.1 * rise);
    CHECK(compare({{0, depth}, {60, depth + rise}}, 85) < 0.1 * rise);
    Series tide;
    for (int t = 0; t <= 120; ++t) tide.push_back({1.0 * t, depth + rise * std::sin(2 * std::numbers::pi * t / 120)});
    CHECK(compare(tide, 120) < 0.1 * rise);
}

TEST_CASE("a stage across a basin at an angle to the grid gives the levels of a straight one", "[site]") {
    using namespace outlets_test;
    constexpr double rise = 0.02;
    const auto levels = [](double degrees) {
        Scene scene = empty_site(70, 50, 1);
        const validation::Turn turn(6, 8, degrees);
        Site& site = *scene.site;
        site.houses = {validation::house_of(turn.box(-30, 90, -90, 0)), validation::house_of(turn.box(-30, 90, 8, 90)),
                       validation::house_of(turn.box(50, 90, -1, 9))};
        site.water = {{{}, 2}};
        site.outlets = {{"sea", OutletKind::stage, turn.box(-20, 0, -1, 9), {}, {{0, 2}, {20, 2 + rise}}}};
        ShallowWater world(scene);
        std::vector<double> found;
        for (double time = 1; time <= 45; ++time) {
            run_until(world, time);
            const MapPoint at = turn(46, 4);
            const std::size_t row = world.grid.row(static_cast<std::ptrdiff_t>(at.z));
            found.push_back(world.water.h[row + static_cast<std::size_t>(at.x)] - 2);
        }
        return found;
    };
    const std::vector<double> straight = levels(0), turned = levels(30);
    double worst = 0;
    for (std::size_t n = 0; n < straight.size(); ++n) worst = std::max(worst, std::abs(straight[n] - turned[n]));
    CHECK(*std::max_element(straight.begin(), straight.end()) > 1.8 * rise);  // at the wall it doubles
    CHECK(worst < 0.2 * rise);  // the mouth is a staircase, a cell deep, of 50
}

// The values contain the seiche of the basin and a bore; 2 cm and 2 % are the accuracy that the project asks for.
TEST_CASE("the level at a stage follows its series however fast it changes", "[site]") {
    using namespace outlets_test;
    CHECK(levels_of(harbour({{0, 1}}, 1), 60).far == Approx(1).margin(1e-9));
    const Levels dip = levels_of(harbour(dip_to(-2), 1), 600), deep = levels_of(harbour(dip_to(-10), 1), 600);
    CHECK(dip.far == Approx(1.39).margin(0.02));
    CHECK(deep.far == Approx(dip.far).margin(0.02));
    const Levels bore = levels_of(harbour(surge, 0.2), 600);
    CHECK(bore.near == Approx(3.18).epsilon(0.02));
    CHECK(bore.far == Approx(4.09).epsilon(0.02));
    Series tide;  // 0.5 to 2 m in ten minutes
    for (int t = 0; t <= 2400; t += 20)
        tide.push_back({1.0 * t, 1.25 + 0.75 * std::cos(2 * std::numbers::pi * t / 1200)});
    CHECK(levels_of(harbour(tide, 2), 2400).far == Approx(2).margin(0.02));
}

TEST_CASE("a stage below the bed counts like one at the bed", "[site]") {
    using namespace outlets_test;
    const auto left = [](double lowest) {
        ShallowWater world(harbour({{0, 1}, {20, 1}, {20, lowest}}, 1));
        run_until(world, 200);
        return world.water.h;
    };
    const RowMemory at_bed = left(0);
    for (const double lowest : {-0.5, -2.0, -10.0, -900.0}) CHECK((left(lowest) == at_bed));
}

// The seiche of the basin goes on, as friction is small and the mouth reflects it; its mean over a period is the level.
TEST_CASE("five minutes after a stage came to rest the level inside is that of the stage", "[site]") {
    using namespace outlets_test;
    const Levels dip = levels_of(harbour(dip_to(-2), 1), 540 + seiche(0.97), 540, 540 + seiche(0.97));
    CHECK(dip.mean_near == Approx(1).margin(0.02));
    CHECK(dip.mean_far == Approx(1).margin(0.02));
    const Levels bore = levels_of(harbour(surge, 0.2), 460 + seiche(2.97), 460, 460 + seiche(2.97));
    CHECK(bore.mean_near == Approx(3).margin(0.02));
    CHECK(bore.mean_far == Approx(3).margin(0.02));
}

// A wave of 2 cm over 1 m of water runs from the middle towards the outlet and comes back, or not.
TEST_CASE("a wave from inside comes back inverted at a stage and leaves at open water", "[site]") {
    using namespace outlets_test;
    const auto reflected = [](OutletKind kind) {
        constexpr double height = 0.02;
        ShallowWater world(basin_with(kind, {{0, 1}}, 100, 0.5, 1));
        const auto depth = [](double x) { return 1 + height * std::exp(-std::pow((x - 50) / 4, 2)); };
        set_water(
            world, [&](double x, double) { return depth(x); },
            [&](double x, double) { return -2 * (std::sqrt(g * depth(x)) - std::sqrt(g)); },
            [](double, double) { return 0.0; });
        double came = 0, back = 0;  // at 25 m; the outlet is reached after 16 s
        run_and_look(world, 32, [&](double time) {
            const double rise = level_at(world, 25.25) - 1;
            if (time < 16) came = std::max(came, rise);
            if (time > 16 && std::abs(rise) > std::abs(back)) back = rise;
        });
        return back / came;
    };
    CHECK(reflected(OutletKind::stage) == Approx(-1).margin(0.05));  // the scheme's own wear over 100 cells
    CHECK(std::abs(reflected(OutletKind::wave)) < 0.02);             // the mouth is a cell long, the wave 16
}

TEST_CASE("open water lets a given wave in, and its reflection out", "[site]") {
    using namespace outlets_test;
    constexpr double height = 0.1;
    const Series series{{0, 1}, {1, 1 + height}, {4, 1 + height}, {5, 1}};
    ShallowWater world(basin_with(OutletKind::wave, series, 100, 0.5, 1));
    double highest = 0, left = 0;
    run_and_look(world, 80, [&](double time) {
        const double rise = level_at(world, 10.25) - 1;
        if (time < 20) highest = std::max(highest, rise);
        if (time > 75) left = std::max(left, std::abs(rise));
    });
    CHECK(std::abs(highest - height) < 0.003);  // the scheme's own wear over 20 cells
    CHECK(left < 0.02 * height);                // as for one wave from inside
}

TEST_CASE("a lake at rest stays at rest beside a stage or open water at its level", "[site]") {
    using namespace outlets_test;
    for (const OutletKind kind : {OutletKind::stage, OutletKind::wave}) {
        Scene scene = empty_site(30, 20, 0.5);
        const validation::Turn turn(15, 10, 25);
        Site& site = *scene.site;
        site.ground.raster = validation::raster_of(30, 20, 0.5, [](double x, double z) {
            return 0.8 * std::sin(0.5 * x) * std::cos(0.4 * z);  // a shore and islands
        });
        site.houses = {validation::house_of(turn.box(-3, 3, -2, 2))};
        site.water = {{{}, 0.3}};
        site.outlets = {{"line", kind, {}, {turn(-12, -8), turn(-12, 8)}, {{0, 0.3}}},
                        {"area", kind, turn.box(9, 12, -6, 6), {}, {{0, 0.3}}}};
        ShallowWater world(scene);
        run_and_look(world, 20, [](double) {});
        double fastest = 0;
        for_each_cell(world.grid, [&](double, double, std::size_t c) {
            fastest = std::max(fastest, std::hypot(world.primitive.u[c], world.primitive.v[c]));
        });
        CHECK(fastest < 1e-12);  // rounding of a surface 0.3 m high
    }
}

// Water at rest that falls dry outside, and a wave much higher than the water is deep.
TEST_CASE("open water takes any level", "[site]") {
    using namespace outlets_test;
    for (const double level : {-1.0, 0.0, 0.01, 4.0}) {
        ShallowWater world(basin_with(OutletKind::wave, {{0, 0.5}, {10, level}}, 30, 0.5, 0.5));
        run_and_look(world, 60, [&](double) {
            for_each_cell(world.grid, [&](double, double, std::size_t c) {
                REQUIRE(world.water.h[c] >= 0);
                REQUIRE(std::isfinite(world.primitive.u[c]));
            });
        });
        CHECK(level_at(world, 20) < (level > 1 ? 4 * level : 0.5));
    }
}

// The line has water on both sides. For a closed basin it then holds the level, too, as soon as waves have crossed it twice.
TEST_CASE("a stage with its line within the water holds its level", "[site]") {
    using namespace outlets_test;
    Scene scene = harbour({{0, 1}, {60, 2}}, 1);
    scene.site->outlets[0].line = {{20.5, 0}, {20.5, 4}};
    ShallowWater world(scene);
    run_and_look(world, 360, [](double) {});
    for (const double x : {2.5, 57.5}) CHECK(level_at(world, x) == Approx(2).margin(0.02));
}

// Parts of the line end on a face and in a cell, and areas on a face and in the middle of cells.
TEST_CASE("outlets end to end give the bits of one outlet, and each has its own cells", "[site]") {
    using namespace outlets_test;
    const auto hash_of = [](const std::vector<std::pair<MapLine, MapPolygon>>& parts) {
        Scene scene = harbour({{0, 1}, {60, 2}}, 1);
        scene.site->outlets.clear();
        for (const auto& [line, polygon] : parts)
            scene.site->outlets.push_back({"sea", OutletKind::stage, polygon, line, {{0, 1}, {60, 2}}});
        ShallowWater world(scene);
        std::size_t cells = 0;
        for (const SiteOutlet& outlet : world.site->outlets) cells += outlet.cells.size();
        run_and_look(world, 100, [](double) {});
        return std::pair(cells, world.water.h);
    };
    const auto line = [](double from, double to) { return std::pair(MapLine{{0, from}, {0, to}}, MapPolygon()); };
    const auto area = [](double from, double to) {
        return std::pair(MapLine(), MapPolygon{{{{0, from}, {2, from}, {2, to}, {0, to}}}});
    };
    const auto one = hash_of({line(0, 4)});
    CHECK(one.first == 4);
    CHECK(hash_of({line(0, 2), line(2, 4)}) == one);
    CHECK(hash_of({line(0, 1.5), line(1.5, 4)}) == one);
    CHECK(hash_of({line(3, 4), line(0, 1.2), line(1.2, 3)}) == one);
    CHECK(hash_of({area(0, 1.5), area(1.5, 4)}) == hash_of({area(0, 4)}));
}

// All of the discharge comes in, beside the cell that the source shares with an outlet.
TEST_CASE("a source that ends in a cell of an outlet loses nothing there", "[site]") {
    using namespace outlets_test;
    Scene scene = basin_with(OutletKind::free, {}, 10, 1, 0.5);
    scene.site->outlets[0].line = {{0, 0}, {0, 1.5}};
    scene.site->sources = {{"creek", {}, {{0, 1.5}, {0, 4}}, {{0, 0.01}}}};
    const ShallowWater world(scene);
    CHECK(world.site->outlets[0].cells.size() == 2);
    REQUIRE(world.site->sources[0].cells.size() == 2);
    for (const SourceCell& cell : world.site->sources[0].cells) CHECK(cell.per_volume == 0.5);
}

TEST_CASE("a river that leaves through a stage keeps its level at once", "[site]") {
    using namespace outlets_test;
    Scene scene = basin_with(OutletKind::stage, {{0, 1}}, 100, 1, 1, 0.002);
    scene.site->roughness.n = 0.03;
    scene.site->sources = {{"river", {}, {{100, 0}, {100, 4}}, {{0, 0}, {60, 3}}}};  // 0.75 m2/s
    ShallowWater world(scene);
    double worst = 0;
    run_and_look(world, 400, [&](double time) {
        if (time > 60) worst = std::max(worst, std::abs(level_at(world, 2.5) - 1));
    });
    CHECK(worst < 0.02);
}

// q = 0.5 m2/s, slope 0.05, n 0.03: normal depth 0.197 m, Froude number 1.8, conjugate depth 0.42 m.
TEST_CASE("a sea that stands higher than the conjugate depth backs up a supercritical river, a lower one does not",
          "[site]") {
    using namespace outlets_test;
    const auto level = [](double stage) {
        Scene scene = basin_with(OutletKind::stage, {{0, stage}}, 60, 0.5, 0, 0.05);
        scene.site->roughness.n = 0.03;
        scene.site->water.clear();
        scene.site->sources = {{"river", {}, {{60, 0}, {60, 2}}, {{0, 1}}}};
        ShallowWater world(scene);
        set_water(
            world, [](double, double) { return 0.197; }, [](double, double) { return -2.53; },
            [](double, double) { return 0.0; });
        run_and_look(world, 300, [](double) {});
        return level_at(world, 2.25);
    };
    CHECK(level(0.8) == Approx(0.8).margin(0.02));  // its velocity head at 2 m from the mouth is 1 cm more
    CHECK(level(0.3) == Approx(0.197 + 0.05 * 2.25).margin(0.005));  // steps of 0.5 m along the bed are 25 mm
}

// Depth times velocity of the cell before the fall is some per cent off.
TEST_CASE("the discharge of a gauge is that through the faces of its cell, beside a fall, too", "[site]") {
    using namespace outlets_test;
    Scene scene = basin_with(OutletKind::free, {}, 60, 1, 0.5, 0.01);
    scene.site->roughness.n = 0.03;
    scene.site->sources = {{"river", {}, {{60, 0}, {60, 4}}, {{0, 4}}}};
    ShallowWater world(scene);
    for (const std::size_t column : {0U, 1U, 2U, 20U}) world.gauged.push_back({1, column});
    run_and_look(world, 600, [](double) {});
    for (const GaugedCell& cell : world.gauged) {
        CAPTURE(cell.column);
        CHECK(cell.qx == Approx(-1).epsilon(0.001));  // steady to that
        CHECK(std::abs(cell.qz) < 1e-9);              // rounding
    }
}

}  // namespace wade::fluid::shallow_water
