// The shallow-water model against exact solutions. Thresholds are those of tests/validation/thresholds.csv where a case
// has one there.

#include <catch2/catch.hpp>
#include <functional>
#include <numbers>

#include "configs/scene/channel.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/world.hpp"
#include "tests/validation/open_channel.hpp"
#include "tests/validation/shallow_water_exact.hpp"
#include "waters.hpp"

using namespace wade;
using namespace wade::fluid::shallow_water;
using validation::FlowState;

namespace {

constexpr double g = 9.81;

// L1 errors over the cells where the exact depth is above 0.15 m, of 1 m and of sqrt(g 1 m).
struct Errors {
    double depth = 0, speed = 0;
};
Errors against(const ShallowWater& world, double dam_x, const std::function<FlowState(double)>& exact) {
    Errors sum;
    double cells = 0;
    for_each_cell(world.grid, [&](double x, double, std::size_t c) {
        const FlowState truth = exact(dam_x - x);
        if (truth.depth <= 0.15) return;
        ++cells;
        sum.depth += std::abs(world.water.h[c] - truth.depth);
        sum.speed += std::abs(-world.primitive.u[c] - truth.velocity) / std::sqrt(g);
    });
    return {sum.depth / cells, sum.speed / cells};
}

// A dam of 1 m at x = 70 m, its reservoir 50 m long; the worst of several times.
Errors dam_break(double depth_before, const std::function<FlowState(double s, double t)>& exact) {
    Scene scene = basin(120, 0.5, 0.5);
    scene.channel->water_blocks = {{{70, 120}, {0, 0.5}, 1.0}};
    if (depth_before > 0) scene.channel->water_blocks.push_back({{0, 70}, {0, 0.5}, depth_before});
    ShallowWater world(scene);
    Errors worst;
    for (double t = 4; t <= 10; t += 2) {
        run_until(world, t);
        const Errors now = against(world, 70, [&](double s) { return exact(s, t); });
        worst = {std::max(worst.depth, now.depth), std::max(worst.speed, now.speed)};
    }
    return worst;
}

// The bump of the SWASHES cases, s downstream = length - x, as a table of points.
std::vector<BedPoint> bump_points(double origin) {
    std::vector<BedPoint> points;
    for (int k = 0; k <= 80; ++k) {
        const double s = 12 - 0.05 * k;
        points.push_back({origin - s, validation::bump_height(s)});
    }
    return points;
}

// sqrt(sum (h - exact)^2 / sum exact^2), and the largest |q / q_mean - 1|, over a stretch of x.
struct SteadyErrors {
    double depth = 0, discharge = 0, mean_discharge = 0;
};
SteadyErrors steady_errors(const ShallowWater& world, const Interval& x, double origin,
                           const validation::BumpFlow& flow) {
    double squares = 0, truth = 0, q = 0, cells = 0;
    for_each_cell(world.grid, [&](double place, double, std::size_t c) {
        if (!x.contains(place)) return;
        const double exact = flow.depth(origin - place);
        squares += (world.water.h[c] - exact) * (world.water.h[c] - exact), truth += exact * exact;
        q -= world.water.qx[c], ++cells;
    });
    SteadyErrors errors{std::sqrt(squares / truth), 0, q / cells};
    for_each_cell(world.grid, [&](double place, double, std::size_t c) {
        if (!x.contains(place)) return;
        errors.discharge = std::max(errors.discharge, std::abs(-world.water.qx[c] * cells / q - 1));
    });
    return errors;
}

}  // namespace

TEST_CASE("Ritter's dam break at cells of half a metre", "[shallow_water][exact]") {
    const Errors worst = dam_break(0, [](double s, double t) { return validation::ritter(s, t, 1, g); });
    CAPTURE(worst.depth, worst.speed);
    CHECK(worst.depth <= 0.02);
    CHECK(worst.speed <= 0.09);
}

TEST_CASE("Stoker's dam break at cells of half a metre", "[shallow_water][exact]") {
    const double before = GENERATE(0.1, 0.2, 0.5);
    const validation::WetDamBreak dam = validation::solve_wet_dam_break(1, before, g);
    const Errors worst = dam_break(before, [&](double s, double t) { return validation::stoker(dam, s, t); });
    CAPTURE(before, worst.depth, worst.speed);
    CHECK(worst.depth <= 0.02);
    CHECK(worst.speed <= 0.09);
}

// A simple wave: u = 2 (c - c_0) and each depth travels at u + c = 3 c - 2 c_0, exactly until it breaks.
TEST_CASE("the order of convergence on a smooth wave is at least 1.7", "[shallow_water][exact]") {
    const double length = 20, depth = 1, height = 0.1, c0 = std::sqrt(g * depth), end = 1.5;
    const auto start = [&](double x) {
        return depth + height * std::exp(-std::pow(std::remainder(x - 10, length) / 2, 2));
    };
    const auto exact = [&](double x, double t) {
        double from = x;
        for (int k = 0; k < 200; ++k) from = x - (3 * std::sqrt(g * start(from)) - 2 * c0) * t;
        return start(from);
    };
    std::vector<double> errors;
    for (const double cell : {0.2, 0.1, 0.05}) {
        ShallowWater world(river(length, cell, cell, depth, 0));
        // Means over the cell, by Gauss' two points.
        const double a = cell / 2 / std::sqrt(3.0);
        const auto mean = [&](double x, const auto& f) { return 0.5 * (f(x - a) + f(x + a)); };
        const auto speed = [&](double x) { return 2 * (std::sqrt(g * start(x)) - c0); };
        set_water(
            world, [&](double x, double) { return mean(x, start); },
            [&](double x, double) { return mean(x, [&](double y) { return start(y) * speed(y); }) / mean(x, start); },
            [](double, double) { return 0.0; });
        run_until(world, end);
        double error = 0;
        for_each_cell(world.grid, [&](double x, double, std::size_t c) {
            const double truth = mean(x, [&](double y) { return exact(y, end); });
            error += std::abs(world.water.h[c] - truth) * cell / length;
        });
        errors.push_back(error);
    }
    CAPTURE(errors[0], errors[1], errors[2]);
    CHECK(std::log2(errors[0] / errors[1]) >= 1.7);
    CHECK(std::log2(errors[1] / errors[2]) >= 1.7);
}

// Thacker (1981): a plane surface that turns in a paraboloid, here cut through its middle: the parabolic channel, where the
// surface stays a plane and swings with the period 2 pi a / sqrt(2 g h_0).
TEST_CASE("Thacker's plane surface swings in a parabolic bowl", "[shallow_water][exact]") {
    const double length = 40, a = 10, depth = 1, swing = 1;
    const double omega = std::sqrt(2 * g * depth) / a, period = 2 * std::numbers::pi / omega;
    Scene scene = basin(length, 0.25, 0.25);
    for (double x = 0; x <= length; x += 0.125) {
        scene.channel->bed_points.push_back({x, depth * std::pow((x - 20) / a, 2)});
    }
    scene.channel->water_blocks = {{{0, length}, {0, 0.25}, depth}};
    ShallowWater world(scene);
    // u = -s w sin(w t); the surface is h_0 + h_0 (2 s cos(w t) (x - 20) - s^2 cos^2(w t)) / a^2, s the swing of the
    // middle of the water.
    const auto surface = [&](double x, double t) {
        const double shift = swing * std::cos(omega * t);
        return depth + depth / (a * a) * (2 * shift * (x - 20) - shift * shift);
    };
    const auto bed = [&](std::size_t c) { return world.bed.height[c]; };
    const auto set = [&](double t) {
        for_each_cell(world.grid, [&](double x, double, std::size_t c) {
            world.water.h[c] = std::max(0.0, surface(x, t) - bed(c));
            world.water.qx[c] = -world.water.h[c] * swing * omega * std::sin(omega * t);
        });
        update_primitive(world);
    };
    set(0);
    const double before = volume(world);
    run_until(world, 2 * period);
    double error = 0, sum = 0;
    for_each_cell(world.grid, [&](double x, double, std::size_t c) {
        const double truth = std::max(0.0, surface(x, 0) - bed(c));
        error += std::abs(world.water.h[c] - truth), sum += truth;
    });
    CAPTURE(error / sum);
    CHECK(error / sum <= 0.02);  // two centimetres in a metre, as over the bumps
    CHECK(std::abs(volume(world) / before - 1) <= 1e-13);
}

TEST_CASE("subcritical flow over a bump", "[shallow_water][exact]") {
    const double cell = GENERATE(0.2, 0.1);
    const double q = 4.42, origin = 25;
    const validation::BumpFlow flow = validation::subcritical_bump_flow(q, 2, g);
    double mean_depth = 0, mean_surface = validation::mean_surface(flow, 0, origin);
    for (int i = 0; i < 10000; ++i) mean_depth += flow.depth((i + 0.5) * origin / 10000) / 10000;
    Scene scene = river(origin, cell, cell, mean_surface, q / mean_depth);
    scene.channel->flow = Flow::recirculating;
    scene.channel->bed_points = bump_points(origin);
    ShallowWater world(scene);
    set_water(
        world, [&](double x, double) { return flow.depth(origin - x); },
        [&](double x, double) { return -q / flow.depth(origin - x); }, [](double, double) { return 0.0; });
    run_until(world, 60);
    const SteadyErrors errors = steady_errors(world, {0, origin}, origin, flow);
    CAPTURE(cell, errors.depth, errors.discharge, errors.mean_discharge);
    CHECK(errors.depth <= 0.02);
    CHECK(errors.discharge <= 0.01);
}

TEST_CASE("transcritical flow over a bump, from the inflow to the fall", "[shallow_water][exact]") {
    const double cell = GENERATE(0.2, 0.1);
    const double q = 1.53, origin = 16;
    const validation::BumpFlow flow = validation::transcritical_bump_flow(q, g);
    Scene scene = basin(12, cell, cell);
    scene.channel->flow = Flow::emitter;
    scene.channel->depth = flow.depth(0), scene.channel->velocity = q / flow.depth(0);
    scene.channel->initial_river = InitialRiver::filled;
    scene.channel->bed_points = bump_points(origin);
    ShallowWater world(scene);
    run_until(world, 60);
    const SteadyErrors errors = steady_errors(world, {1, 11}, origin, flow);
    CAPTURE(cell, errors.depth, errors.discharge, errors.mean_discharge);
    CHECK(errors.depth <= 0.02);
    CHECK(errors.discharge <= 0.01);
    CHECK(errors.mean_discharge == Approx(q).epsilon(1e-3));
}

TEST_CASE("a uniform river on a slope holds the depth and speed of Manning's formula", "[shallow_water][exact]") {
    const double slope = 0.002, n = 0.03;
    const double truth = std::sqrt(slope) / n;  // of 1 m
    Scene scene = river(10, 6, 0.5, 1, 0.8 * truth);
    scene.channel->slope = slope, scene.channel->manning_n = n;
    ShallowWater world(scene);
    run_until(world, 240);
    const std::size_t c = world.grid.row(3) + 7;
    const double then = -world.primitive.u[c];
    CHECK(world.water.h[c] == Approx(1).epsilon(1e-12));
    CHECK(then == Approx(truth).epsilon(1e-3));  // g sin and cos of the slope: 1e-6
    run_until(world, 300);
    CHECK(std::abs(-world.primitive.u[c] / then - 1) <= 1e-3);
}

TEST_CASE("a river that is driven holds its speed, and its history of speeds", "[shallow_water][exact]") {
    Scene scene = river(20, 4, 0.5, 1, 1.5);
    scene.channel->flow = Flow::recirculating;
    scene.channel->velocity_history = {{0, 1.5}, {5, 1.5}, {10, 2}};
    ShallowWater world(scene);
    run_until(world, 4);
    CHECK(-world.primitive.u[world.grid.row(2) + 5] == Approx(1.5).epsilon(1e-12));
    const StepReport report = step(world, 1e-3);
    CHECK(std::abs(report.driving_acceleration) <= 1e-9);
    run_until(world, 12);
    CHECK(-world.primitive.u[world.grid.row(2) + 5] == Approx(2).epsilon(1e-12));
}

TEST_CASE("the inflow of a slow stream onto dry ground is critical", "[shallow_water][exact]") {
    Scene scene = basin(60, 0.5, 0.5);
    scene.world->gravity = 0.98;
    scene.channel->flow = Flow::emitter;
    scene.channel->depth = 1, scene.channel->velocity = 0.5;
    ShallowWater world(scene);
    run_until(world, 25);
    // A fan of waves from the opening: u + 2 c = 3 c_0 with c_0 = (q g)^(1/3) = 0.788 m/s, u - c = s / t.
    const double c0 = std::cbrt(0.5 * 0.98);
    for (const std::size_t i : {60U, 90U, 110U}) {
        const double s = 60 - (static_cast<double>(i) + 0.5) * 0.5, c = c0 - s / 25 / 3;
        CAPTURE(s);
        // Two percent of the depth and speed at the opening, as for dam breaks.
        CHECK(world.water.h[world.grid.row(0) + i] == Approx(c * c / 0.98).margin(0.02 * c0 * c0 / 0.98).epsilon(0));
        CHECK(-world.primitive.u[world.grid.row(0) + i] == Approx(3 * c0 - 2 * c).margin(0.02 * 3 * c0).epsilon(0));
    }
}
