// Shallow water on sites with known solutions: bowls and lakes at an angle, a street, long channels, a hydrograph.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "cases.hpp"
#include "fluid_server/shallow_water/step.hpp"
#include "run.hpp"
#include "site_scenes.hpp"

namespace wade::validation {

namespace {

using fluid::shallow_water::ShallowWater;

// Calls body(x, z, cell) with the centre of each cell that is open.
template <typename Body>
void for_each_open(const ShallowWater& world, Body&& body) {
    const fluid::shallow_water::Grid& grid = world.grid;
    for (std::size_t k = 0; k < grid.nz; ++k) {
        for (std::size_t i = 0; i < grid.nx; ++i) {
            const std::size_t c = grid.row(static_cast<std::ptrdiff_t>(k)) + i;
            if (world.openings.share_of(c) <= 0) continue;
            body(grid.x.lo + (static_cast<double>(i) + 0.5) * grid.dx,
                 grid.z.lo + (static_cast<double>(k) + 0.5) * grid.dz, c);
        }
    }
}

double volume_of(const ShallowWater& world) {
    double sum = 0;
    for_each_open(world, [&](double, double, std::size_t c) { sum += world.water.h[c] * world.openings.share_of(c); });
    return sum * world.grid.cell_area();
}

// What came in and went out, m^3.
struct Balance {
    double in = 0, out = 0;
};

Balance run_until(ShallowWater& world, double time, Result& result) {
    Balance balance;
    const double cpu = process_cpu_time(), wall = wall_time(), begin = world.time;
    while (world.time < time - 1e-9) {
        const auto report = fluid::shallow_water::step(world, time - world.time);
        balance.in += report.inflow, balance.out += report.outflow;
        ++result.steps;
        result.particle_steps += static_cast<double>(active_cells(world));
    }
    result.model = "shallow_water";
    result.particles = world.grid.cells();
    result.simulated_time += world.time - begin;
    result.solver_cpu_time += process_cpu_time() - cpu;
    result.solver_wall_time += wall_time() - wall;
    return balance;
}

// Thacker's paraboloid and his trough between slanted walls: the surface stays a plane that swings (W. C. Thacker,
// J. Fluid Mech. 107 (1981), 499-508, as collected by SWASHES). Depth after one period over its largest value.
Result run_bowl(const Request& request) {
    constexpr double degrees = 17, size = 4, deep = 0.5, a = 1, lift = 0.5, wide = 1.2;
    const double omega = std::sqrt(2 * standard_gravity * deep) / a, period = 2 * std::numbers::pi / omega;
    const Turn turn(size / 2, size / 2, degrees);
    Result result;
    const auto error = [&](bool trough) {
        const auto bed = [&](double x, double z) {
            const MapPoint p = turn.back(x, z);
            return deep * ((p.x * p.x + (trough ? 0 : p.z * p.z)) / (a * a) - 1);
        };
        // The plane of the surface at the time 0, when it leans most and, in the trough, is at rest.
        const auto surface = [&](double x, double z) {
            return lift * deep / (a * a) * (2 * turn.back(x, z).x - lift) + 0 * z;
        };
        Scene scene = empty_site(size, size, request.spacing);
        scene.site->ground.raster = raster_of(size, size, request.spacing, bed);
        if (trough) {
            scene.site->houses = {house_of(turn.box(-9, 9, wide / 2, 9)), house_of(turn.box(-9, 9, -9, -wide / 2))};
        }
        ShallowWater world(scene);
        const auto exact = [&](double x, double z, std::size_t c) {
            return std::max(0.0, surface(x, z) - world.bed.height[c]);
        };
        for_each_open(world, [&](double x, double z, std::size_t c) {
            world.water.h[c] = exact(x, z, c);
            const double across = trough ? 0 : lift * omega * world.water.h[c];  // the paraboloid's plane goes round
            world.water.qx[c] = -turn.sine * across;
            world.water.qz[c] = turn.cosine * across;
        });
        update_primitive(world);
        run_until(world, period, result);
        double sum = 0, open = 0;
        for_each_open(world, [&](double x, double z, std::size_t c) {
            if (exact(x, z, c) <= 0 && world.water.h[c] < 1e-3) return;
            sum += world.openings.share_of(c) * std::abs(world.water.h[c] - exact(x, z, c));
            open += world.openings.share_of(c);
        });
        return sum / open / deep;
    };
    const double round = error(false), between_walls = error(true);
    result.metrics = {{"depth_l1", round, "1"}, {"depth_l1_between_walls", between_walls, "1"}};
    return result;
}

// Nothing may move.
Result run_lake(const Request&) {
    Result result;
    double level = 0, hilly = 0;
    for (const bool hills : {false, true}) {
        ShallowWater world(lake(17, hills));
        run_until(world, 10, result);
        double& fastest = hills ? hilly : level;
        for_each_open(world, [&](double, double, std::size_t c) {
            fastest = std::max(fastest, std::hypot(world.primitive.u[c], world.primitive.v[c]));
        });
    }
    result.metrics = {{"fastest_over_level_ground", level, "m/s"}, {"fastest_over_hills", hilly, "m/s"}};
    return result;
}

// Depth and speed along the street, means of 1 m.
struct Along {
    std::vector<double> depth = std::vector<double>(28, 0), speed = std::vector<double>(28, 0);
};
Along along_street(double degrees, double cell, Result& result) {
    ShallowWater world(street(degrees, cell));
    run_until(world, 2, result);
    const Turn turn(20, 20, degrees);
    Along along;
    std::vector<double> open(28, 0);
    for_each_open(world, [&](double x, double z, std::size_t c) {
        const MapPoint p = turn.back(x, z);
        if (std::abs(p.x) >= 14 || std::abs(p.z) > 3) return;
        const auto n = static_cast<std::size_t>(p.x + 14);
        const double share = world.openings.share_of(c);
        open[n] += share;
        along.depth[n] += share * world.water.h[c];
        along.speed[n] += share * (turn.cosine * world.water.qx[c] + turn.sine * world.water.qz[c]);
    });
    for (std::size_t n = 0; n < open.size(); ++n) {
        along.speed[n] = along.depth[n] > 0.02 * open[n] ? along.speed[n] / along.depth[n] : 0;
        along.depth[n] /= open[n];
    }
    return along;
}

Result run_street(const Request& request) {
    Result result;
    const Along straight = along_street(0, request.spacing, result), turned = along_street(30, request.spacing, result);
    double depth = 0, speed = 0;
    Curve curve{"street", {"s_m", "turned_m", "straight_m", "turned_m_s", "straight_m_s"}, {}};
    for (std::size_t n = 0; n < 28; ++n) {
        depth += std::abs(turned.depth[n] - straight.depth[n]) / 28;
        speed += std::abs(turned.speed[n] - straight.speed[n]) / 28;
        curve.rows.push_back(
            {static_cast<double>(n) - 13.5, turned.depth[n], straight.depth[n], turned.speed[n], straight.speed[n]});
    }
    result.metrics = {{"depth_l1", depth, "1"}, {"speed_l1", speed / std::sqrt(standard_gravity), "1"}};
    result.curves = {curve};
    return result;
}

// MacDonald's channels of 1000 m with q = 2 m2/s (I. MacDonald et al., J. Hydraul. Eng. 123 (1997), 1041-1045, as collected by
// SWASHES): the depth is chosen, and the bed that gives it follows from dz/dx = (q^2 / (g h^3) - 1) dh/dx - n^2 q^2 / h^(10/3).
struct LongChannel {
    double n;
    double (*share)(double s);  // of the critical depth; s in [0, 1]
    bool falls;                 // runs out supercritical
};
double subcritical_share(double s) {
    return 1 + 0.5 * std::exp(-16 * (s - 0.5) * (s - 0.5));
}
double transcritical_share(double s) {
    return s < 0.5 ? 1 - std::tanh(3 * (s - 0.5)) / 3 : 1 - std::tanh(6 * (s - 0.5)) / 6;
}

double error_of(const LongChannel& channel, double cell, Result& result) {
    constexpr double length = 1000, width = 20, q = 2;
    const double critical = std::cbrt(q * q / standard_gravity);
    const auto depth = [&](double x) { return critical * channel.share(x / length); };
    std::vector<double> bed(static_cast<std::size_t>(length) * 10 + 1, 0);  // every 0.1 m, from the lower end
    for (std::size_t n = bed.size() - 1; n-- > 0;) {
        const double x = (static_cast<double>(n) + 0.5) * 0.1, h = depth(x);
        const double rise = (depth(x + 1e-4) - depth(x - 1e-4)) / 2e-4;
        const double slope =
            (q * q / (standard_gravity * h * h * h) - 1) * rise - channel.n * channel.n * q * q / std::pow(h, 10.0 / 3);
        bed[n] = bed[n + 1] - 0.1 * slope;
    }
    const auto height = [&](double x) {
        const double at = std::clamp(x * 10, 0.0, static_cast<double>(bed.size()) - 1.001);
        const auto n = static_cast<std::size_t>(at);
        return bed[n] + (at - static_cast<double>(n)) * (bed[n + 1] - bed[n]);
    };
    Scene scene = empty_site(length, width, cell);
    Site& site = *scene.site;
    site.ground.raster = raster_of(length, width, cell, [&](double x, double) { return height(x); });
    site.roughness.n = channel.n;
    site.sources = {{"upstream", {}, {{0, 0}, {0, width}}, {{0, q * width}}}};
    site.outlets = {{"downstream", OutletKind::free, {}, {{length, 0}, {length, width}}, {}}};
    if (!channel.falls) {
        site.outlets[0].kind = OutletKind::stage;
        const double end = length - 0.5 * cell;  // the centre of the outlet's cells
        site.outlets[0].stage = {{0, height(end) + depth(end)}};
    }
    ShallowWater world(scene);
    for_each_open(world, [&](double x, double, std::size_t c) { world.water.h[c] = depth(x); });
    update_primitive(world);
    run_until(world, 3000, result);
    double error = 0, count = 0;
    for_each_open(world, [&](double x, double, std::size_t c) {
        if (x < 20 || x > length - 20) return;  // water comes in without momentum, and the fall draws down
        error += std::abs(world.water.h[c] - depth(x)) / critical;
        error += std::abs(world.water.qx[c] - q) / q;
        count += 1;
    });
    return error / count;
}

Result run_long_channels(const Request& request) {
    Result result;
    const double subcritical = error_of({0.033, subcritical_share, false}, request.spacing, result);
    const double transcritical = error_of({0.0218, transcritical_share, true}, request.spacing, result);
    result.metrics = {{"depth_and_discharge_subcritical", subcritical, "1"},
                      {"depth_and_discharge_transcritical", transcritical, "1"}};
    return result;
}

// Storm and hydrograph on a hillside with houses.
Result run_hydrograph(const Request& request) {
    Scene scene = empty_site(60, 40, request.spacing);
    const Turn turn(30, 20, 25);
    Site& site = *scene.site;
    site.ground.raster = raster_of(60, 40, 1, [](double x, double z) {
        return 4 - 0.1 * x + 0.3 * std::sin(0.5 * x + 0.2 * z) + 0.01 * (z - 20) * (z - 20);
    });
    site.roughness.n = 0.03;
    site.roughness.zones = {{turn.box(-4, 4, -4, 4), 0.1}};
    site.houses = {house_of(turn.box(-3, 3, -2, 2)), house_of(turn.box(8, 13, -5, 0.7)),
                   house_of(turn.box(8, 13, 2, 9))};
    site.sources = {{"hill", turn.box(-25, -22, -2, 2), {}, {{0, 0}, {20, 3}, {60, 1}, {80, 0}}}};
    site.rain = {{0, 0}, {10, 200}, {40, 0}};
    site.outlets = {{"valley", OutletKind::free, {}, {{60, 0}, {60, 40}}, {}}};
    ShallowWater world(scene);
    Result result;
    const Balance balance = run_until(world, 200, result);
    const double source = 30 + 80 + 10, rain = 0.2 / 3600 * 20 * (60 * 40 - 24 - 28.5 - 35);
    double shallowest = 0;
    for_each_open(world, [&](double, double, std::size_t c) { shallowest = std::min(shallowest, world.water.h[c]); });
    result.metrics = {{"balance", std::abs(volume_of(world) + balance.out - balance.in) / balance.in, "1"},
                      {"inflow", std::abs(balance.in / (source + rain) - 1), "1"},
                      {"left_behind", volume_of(world) / balance.in, "1"},
                      {"negative_depth", -shallowest, "m"}};
    return result;
}

}  // namespace

Case site_bowl_case() {
    return {.name = "site_bowl",
            .truth =
                "Thacker (1981): in a paraboloid the plane surface of the water goes round, in a trough between two "
                "walls it "
                "swings, both turned by 17 degrees against the grid, wet and dry, after one period. Depth over that of "
                "the bowl.",
            .reference = "Thacker 1981",
            .spacings = {0.04, 0.02},
            .quick = true,
            .run = run_bowl};
}

Case site_lake_case() {
    return {.name = "site_lake",
            .truth =
                "Nothing moves in a lake with houses at 17 degrees, over level ground and over hills with a shore, in "
                "10 s.",
            .reference = "rest",
            .spacings = {0.5},
            .quick = true,
            .run = run_lake};
}

Case site_street_case() {
    return {
        .name = "site_street",
        .truth =
            "A dam break down a street at 30 degrees against the grid, beside the same in a straight one: depth over H "
            "and speed over sqrt(g H), means of each metre of the street, 2 s after it.",
        .reference = "the straight street",
        .spacings = {0.25, 0.125},
        .quick = true,
        .run = run_street};
}

Case site_long_channels_case() {
    return {.name = "site_long_channels",
            .truth =
                "MacDonald et al. (1997): steady flow in channels of 1000 m with friction, subcritical before a given "
                "stage, "
                "and from sub- to supercritical over a fall. Errors of depth over the critical depth and of the "
                "discharge, summed.",
            .reference = "MacDonald 1997",
            .spacings = {5, 2.5},
            .quick = true,
            .run = run_long_channels};
}

Case site_hydrograph_case() {
    return {
        .name = "site_hydrograph",
        .truth = "What a hydrograph and rain bring to a hillside with houses is what stands there and what went out.",
        .reference = "mass",
        .spacings = {0.5},
        .quick = true,
        .run = run_hydrograph};
}

}  // namespace wade::validation
