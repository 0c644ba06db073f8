// Water on a site: walls at any angle, wet and dry ground, what comes and goes.
#include <catch2/catch.hpp>
#include <cmath>

#include "configs/scene/fluid.hpp"
#include "fluid_server/shallow_water/site/map_cover.hpp"
#include "fluid_server/shallow_water/site/site_ground.hpp"
#include "tests/validation/site_scenes.hpp"
#include "waters.hpp"

namespace wade::fluid::shallow_water {

using validation::empty_site;
using validation::house_of;
using validation::raster_of;
using validation::street;
using validation::Turn;

namespace {

double open_volume(const ShallowWater& world) {
    double sum = 0;
    for_each_cell(world.grid,
                  [&](double, double, std::size_t c) { sum += world.water.h[c] * world.openings.share_of(c); });
    return sum * world.grid.cell_area();
}

double fastest(const ShallowWater& world) {
    double most = 0;
    for_each_cell(world.grid, [&](double, double, std::size_t c) {
        most = std::max(most, std::hypot(world.primitive.u[c], world.primitive.v[c]));
    });
    return most;
}

double shallowest(const ShallowWater& world) {
    double least = 1e300;
    for_each_cell(world.grid, [&](double, double, std::size_t c) { least = std::min(least, world.water.h[c]); });
    return least;
}

}  // namespace

TEST_CASE("polygons cover cells and faces by their area", "[site]") {
    const Grid grid = make_grid(empty_site(8, 4, 1));
    // A square of 2 x 2 on its corner, centred at (4, 2), and a hole in it.
    const MapPolygon diamond{
        {{{4, 0.5}, {5.5, 2}, {4, 3.5}, {2.5, 2}}, {{3.9, 1.9}, {4.1, 1.9}, {4.1, 2.1}, {3.9, 2.1}}}};
    const Cover cover = cover_of(grid, {&diamond});
    double area = 0;
    for (const double share : cover.cell) area += share;
    CHECK(std::abs(area - (2 * 1.5 * 1.5 - 0.04)) < 0.02);                // 16 lines a cell
    CHECK(std::abs(cover.face_x[1 * 9 + 4] - (0.5 + 0.5 - 0.1)) < 1e-6);  // x = 4, z from 1 to 2
    CHECK(std::abs(cover.face_z[2 * 8 + 2] - 0.5) < 1e-6);                // z = 2, x from 2 to 3
    CHECK(cover.face_z[2 * 8 + 6] == 0);
    // Two houses that share a wall cover it once.
    const MapPolygon left = Turn(0, 0, 0).box(1, 2.5, 1, 2), right = Turn(0, 0, 0).box(2.5, 4, 1, 2);
    CHECK(cover_of_cells(grid, {&left, &right})[1 * 8 + 2] == 1);
    // A line on the far edge is in the last cells.
    CHECK(cells_on(grid, {{8, 0.5}, {8, 1.5}}) == std::vector<std::size_t>{7, 15});
    CHECK(cells_on(grid, {{0.5, 0.5}, {2.5, 2.5}}).front() == 0);
}

TEST_CASE("ground is straight between the centres of a raster, its mean in larger cells, and through points",
          "[site]") {
    const Grid grid = make_grid(empty_site(8, 4, 1));
    const auto plane = [](double x, double z) { return 0.1 * x + 0.2 * z; };
    Ground ground;
    for (const double cell : {0.25, 1.0, 2.0}) {
        ground.raster = raster_of(8, 4, cell, plane);
        const RowMemory height = ground_heights(ground, grid);
        for_each_cell(grid, [&](double x, double z, std::size_t c) {
            if (x < 1 || x > 7 || z < 1 || z > 3) return;  // constant in the outer half of the raster's cells
            CHECK(std::abs(height[c] - plane(x, z)) < 1e-12);
        });
    }
    ground.raster.reset();
    ground.points = {{0, 0, 0}, {8, 0.8, 0}, {0, 0.8, 4}, {8, 1.6, 4}, {3, 0.3 + 0.4, 2}};
    const RowMemory height = ground_heights(ground, grid);
    for_each_cell(grid, [&](double x, double z, std::size_t c) { CHECK(std::abs(height[c] - plane(x, z)) < 1e-12); });
}

TEST_CASE("a lake with houses at an angle stays at rest", "[site]") {
    SECTION("over level ground to the last bit") {
        ShallowWater world(validation::lake(17, false));
        REQUIRE_FALSE(world.openings.groups.empty());
        const RowMemory before = world.water.h;
        run_until(world, 5);
        CHECK(fastest(world) == 0);
        CHECK((world.water.h == before));
    }
    SECTION("over hills with a shore to rounding") {
        ShallowWater world(validation::lake(17, true));
        run_until(world, 5);
        CHECK(fastest(world) < 1e-12);  // m/s; rounding of a surface 1 m high
    }
}

TEST_CASE("a dam break down a street at an angle is that down a straight one", "[site]") {
    // At 30 degrees against 0, by positions along the street: the project asks for 2 % of H and of sqrt(g H).
    constexpr std::size_t places = 28;
    const auto profile = [&](double degrees, std::vector<double>& speed) {
        ShallowWater world(street(degrees, 0.25));
        run_until(world, 2);
        const Turn turn(20, 20, degrees);
        std::vector<double> volume(places, 0), open(places, 0), discharge(places, 0);
        for_each_cell(world.grid, [&](double x, double z, std::size_t c) {
            const MapPoint p = turn.back(x, z);
            if (std::abs(p.x) > 14 || std::abs(p.z) > 3) return;
            const auto n = static_cast<std::size_t>((p.x + 14) / 28 * (places - 1e-9));
            const double share = world.openings.share_of(c);
            open[n] += share;
            volume[n] += share * world.water.h[c];
            discharge[n] += share * (turn.cosine * world.water.qx[c] + turn.sine * world.water.qz[c]);
        });
        speed.resize(places);
        for (std::size_t n = 0; n < places; ++n) {
            speed[n] = volume[n] > 0.02 * open[n] ? discharge[n] / volume[n] : 0;
            volume[n] /= open[n];
        }
        CHECK(std::abs(open_volume(world) - 75) < 0.02);  // 15 x 5 x 1, by 16 lines a cell
        return volume;
    };
    std::vector<double> straight_speed, turned_speed;
    const std::vector<double> straight = profile(0, straight_speed), turned = profile(30, turned_speed);
    double of_depth = 0, of_speed = 0;
    for (std::size_t n = 0; n < places; ++n) {
        of_depth += std::abs(straight[n] - turned[n]) / places;
        of_speed += std::abs(straight_speed[n] - turned_speed[n]) / places;
    }
    CHECK(of_depth < 0.02);
    CHECK(of_speed < 0.02 * std::sqrt(9.81));
}

TEST_CASE("water that slides along a slanted wall is not braked", "[site]") {
    // A ring of streets would need curves. In this long straight street no wave from the ends reaches the middle yet.
    Scene scene = empty_site(60, 60, 0.5);
    const Turn turn(30, 30, 30);
    scene.site->houses = {house_of(turn.box(-40, 40, 2.5, 12)), house_of(turn.box(-40, 40, -12, -2.5))};
    scene.site->water = {{{}, 1}};
    ShallowWater world(scene);
    for_each_cell(world.grid, [&](double, double, std::size_t c) {
        world.water.qx[c] = 2 * turn.cosine * world.water.h[c];
        world.water.qz[c] = 2 * turn.sine * world.water.h[c];
    });
    update_primitive(world);
    run_until(world, 2);
    double worst = 0;
    for_each_cell(world.grid, [&](double x, double z, std::size_t c) {
        const MapPoint p = turn.back(x, z);
        if (std::abs(p.x) > 8 || std::abs(p.z) > 3 || world.openings.share_of(c) <= 0) return;
        worst = std::max({worst, std::abs(world.primitive.u[c] - 2 * turn.cosine),
                          std::abs(world.primitive.v[c] - 2 * turn.sine), std::abs(world.water.h[c] - 1)});
    });
    CHECK(worst < 1e-6);  // faces are cut to a share of 1e-9
}

TEST_CASE("what comes in by hydrograph, rain and stage is what stands there and went out", "[site]") {
    Scene scene = empty_site(30, 20, 0.5);
    const Turn turn(15, 10, 25);
    Site& site = *scene.site;
    site.ground.slope_x = -0.1, site.ground.level = 4;
    site.roughness.n = 0.03;
    site.roughness.zones = {{turn.box(-4, 4, -4, 4), 0.1}};
    site.houses = {house_of(turn.box(-3, 3, -2, 2))};
    site.sources = {{"hill", turn.box(-13, -10, -2, 2), {}, {{0, 0}, {5, 3}, {10, 1}}}};
    site.rain = {{0, 0}, {2, 3000}, {4, 0}};
    site.outlets = {{"sea", OutletKind::free, {}, {{30, 2}, {30, 18}}, {}}};
    ShallowWater world(scene);
    double in = 0, out = 0;
    while (world.time < 30 - 1e-9) {
        const StepReport report = step(world, 30 - world.time);
        in += report.inflow, out += report.outflow;
        REQUIRE(shallowest(world) >= 0);
    }
    CHECK(out > 0.1);
    const double rain = 6.0 / 3600 * (30 * 20 - 24), source = 7.5 + 10 + 20;  // m^3
    CHECK(std::abs(in - rain - source) < 0.01 * rain);                        // the house's area by 16 lines a cell
    CHECK(std::abs(open_volume(world) + out - in) < 1e-9 * in);
}

TEST_CASE("a wall thinner than a cell holds, an alley narrower than one lets through", "[site]") {
    const auto beyond = [](bool alley) {
        Scene scene = empty_site(24, 16, 0.5);
        const Turn turn(12, 8, 20);
        Site& site = *scene.site;
        site.houses = {house_of(turn.box(-0.1, 0.1, -20, alley ? -0.2 : 0)),
                       house_of(turn.box(-0.1, 0.1, alley ? 0.2 : 0, 20))};
        site.water = {{turn.box(-20, -0.8, -20, 20), 1}};
        ShallowWater world(scene);
        const double volume = open_volume(world);
        run_until(world, 3);
        CHECK(std::abs(open_volume(world) - volume) < 1e-12 * volume);
        double sum = 0;
        for_each_cell(world.grid, [&](double x, double z, std::size_t c) {
            if (turn.back(x, z).x > 1) sum += world.water.h[c];
        });
        return sum * world.grid.cell_area();
    };
    CHECK(beyond(false) == 0);
    CHECK(beyond(true) > 0.2);  // 0.4 m wide; a fall of 1 m passes 0.4 * 0.93 m^3/s at most
}

TEST_CASE("depths stay positive and mass is kept on steep and rough ground", "[site]") {
    Scene scene = empty_site(40, 20, 0.5);
    const Turn turn(20, 10, 33);
    Site& site = *scene.site;
    site.roughness.n = 0.04;
    site.ground.raster = raster_of(40, 20, 0.5, [](double x, double z) {
        return 30 - x + 0.5 * std::sin(2 * x) * std::sin(1.7 * z);  // 45 degrees, with bumps
    });
    site.houses = {house_of(turn.box(-4, 4, -3, 3)), house_of(turn.box(8, 10, -6, -2))};
    site.water = {{turn.box(-20, -12, -20, 20), 28}};
    ShallowWater world(scene);
    const double volume = open_volume(world);
    REQUIRE(volume > 10);
    while (world.time < 8) {
        step(world, 8 - world.time);
        REQUIRE(shallowest(world) >= 0);
    }
    CHECK(std::abs(open_volume(world) - volume) < 1e-12 * volume);
}

TEST_CASE("a gate holds water until it opens", "[site]") {
    Scene scene = empty_site(20, 10, 0.5);
    Site& site = *scene.site;
    const Turn turn(10, 5, 20);
    site.barriers = {{.name = "gate", .line = {turn(0, -6), turn(0, 6)}, .opens_at = 1.5}};
    site.water = {{turn.box(-20, -0.8, -20, 20), 1}};
    ShallowWater world(scene);
    const auto beyond = [&] {
        double sum = 0;
        for_each_cell(world.grid, [&](double x, double z, std::size_t c) {
            if (turn.back(x, z).x > 1.5) sum += world.water.h[c];
        });
        return sum;
    };
    run_until(world, 1.5);
    CHECK(beyond() == 0);
    run_until(world, 2.5);
    CHECK(beyond() > 1);
}

TEST_CASE("a gate between walls that end anywhere in a cell is tight", "[site]") {
    for (const double degrees : {0, 17, 30}) {
        Scene scene = empty_site(20, 10, 0.5);
        Site& site = *scene.site;
        const Turn turn(10, 5, degrees);
        site.houses = {house_of(turn.box(-0.5, 0.5, -20, -0.7)), house_of(turn.box(-0.5, 0.5, 1.2, 20))};
        site.barriers = {{.name = "gate", .line = {turn(0, -0.7), turn(0, 1.2)}, .opens_at = 9}};
        site.water = {{turn.box(-20, -0.8, -20, 20), 1}};
        ShallowWater world(scene);
        run_until(world, 4);
        for_each_cell(world.grid, [&](double x, double z, std::size_t c) {
            if (turn.back(x, z).x > 1) REQUIRE(world.water.h[c] == 0);
        });
    }
}

// A wave that runs along x, or along z, into water at rest before its crest breaks: its exact solution follows characteristics.
TEST_CASE("the order of convergence on a site is at least 1.7", "[site]") {
    const double length = 20, depth = 1, height = 0.1, g = 9.81, c0 = std::sqrt(g * depth), end = 1.5;
    const auto start = [&](double x) { return depth + height * std::exp(-std::pow((x - 8) / 2, 2)); };
    const auto speed = [&](double x) { return 2 * (std::sqrt(g * start(x)) - c0); };
    const auto exact = [&](double x) {
        double from = x;
        for (int k = 0; k < 200; ++k) from = x - (3 * std::sqrt(g * start(from)) - 2 * c0) * end;
        return start(from);
    };
    for (const bool along_z : {false, true}) {
        std::vector<double> errors;
        for (const double cell : {0.2, 0.1, 0.05}) {
            ShallowWater world(along_z ? empty_site(8 * cell, length, cell) : empty_site(length, 8 * cell, cell));
            // Means over the cell, by Gauss' two points.
            const double a = cell / 2 / std::sqrt(3.0);
            const auto mean = [&](double x, const auto& f) { return 0.5 * (f(x - a) + f(x + a)); };
            const auto velocity = [&](double x) {
                return mean(x, [&](double y) { return start(y) * speed(y); }) / mean(x, start);
            };
            set_water(
                world, [&](double x, double z) { return mean(along_z ? z : x, start); },
                [&](double x, double) { return along_z ? 0 : velocity(x); },
                [&](double, double z) { return along_z ? velocity(z) : 0; });
            run_until(world, end);
            double error = 0;
            for_each_cell(world.grid, [&](double x, double z, std::size_t c) {
                error += std::abs(world.water.h[c] - mean(along_z ? z : x, exact)) * cell / length / 8;
            });
            errors.push_back(error);
        }
        CAPTURE(along_z, errors[0], errors[1], errors[2]);
        CHECK(std::log2(errors[0] / errors[1]) >= 1.7);
        CHECK(std::log2(errors[1] / errors[2]) >= 1.7);
    }
}

// Half a step without friction would drive the fluxes by dt k/2 too fast, some per cent here.
TEST_CASE("water keeps its normal depth and speed down a slope, whatever the time step", "[site]") {
    const double depth = 0.2, n = 0.05, slope = 0.02, u = std::sqrt(slope) * std::pow(depth, 2.0 / 3) / n;
    for (const double cfl : {0.5, 0.1}) {
        Scene scene = empty_site(60, 4, 0.5);
        scene.fluid->cfl = cfl;
        scene.site->roughness.n = n;
        scene.site->ground.slope_x = -slope, scene.site->ground.level = 2;
        ShallowWater world(scene);
        set_water(
            world, [&](double, double) { return depth; }, [&](double, double) { return u; },
            [](double, double) { return 0.0; });
        run_until(world, 4);
        for_each_cell(world.grid, [&](double x, double, std::size_t c) {
            if (x < 25 || x > 40) return;                              // what comes from the ends is not there yet
            CHECK(std::abs(world.water.h[c] - depth) < 1e-6 * depth);  // k is known to single precision
            CHECK(std::abs(world.primitive.u[c] - u) < 1e-6 * u);
        });
    }
}

TEST_CASE("only cells at the water are worked on, and threads do not matter", "[site]") {
    const auto run = [](int threads) {
        const int before = omp_get_max_threads();
        omp_set_num_threads(threads);
        ShallowWater world(street(30, 0.25));
        run_until(world, 1);
        omp_set_num_threads(before);
        return world;
    };
    const ShallowWater one = run(1), three = run(3);
    CHECK((one.water.h == three.water.h));
    CHECK((one.water.qx == three.water.qx));
    std::size_t active = 0;
    for (std::size_t k = 0; k < one.grid.nz; ++k) {
        one.lines.active.for_each_span(k, [&](std::size_t, std::size_t n) { active += n; });
    }
    CHECK(active < one.grid.cells() / 4);
    CHECK(static_cast<double>(active) > 75 / one.grid.cell_area());
    // All cells at each step give the same water.
    ShallowWater all(street(30, 0.25));
    for (double remaining = 1; remaining > 1e-9; remaining -= step(all, remaining).dt) {
        all.lines.active = Lines(all.grid, true);
    }
    CHECK((all.water.h == one.water.h));
}

}  // namespace wade::fluid::shallow_water
