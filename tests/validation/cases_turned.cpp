// Water of particles between walls at 17 and 45 degrees and over ground that slopes so: at rest it must rest, in motion it must do
// what it does in the straight twin. Particles lie on the lattice of the world, which oblique walls cut, or on the twin's, turned.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "cases.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "fluid_server/particles/site/site_solids.hpp"
#include "run.hpp"
#include "site_scenes.hpp"

namespace wade::validation {

namespace {

constexpr std::array angles{17.0, 45.0};

// A tank in the middle of a world, and what is in it; lengths in m, a along it and b across, from its middle.
struct Tank {
    double length = 1.2, width = 1.2;
    double level = 1;                                         // of the water
    double filled = std::numeric_limits<double>::infinity();  // length of it, from the lower end
    std::vector<MapLine> houses{};                            // corners a, b
    double slope = 0;                                         // of the ground, rising along the tank
    std::function<double(double a, double b)> ground{};       // height, instead
    double time = 5;                                          // s
    bool at_rest = true;
};

Scene scene_of(const Tank& tank, double degrees, double spacing) {
    // Its middle on a node of the lattice, so that the straight twin's walls lie between particles.
    const double side = 2 * spacing * std::ceil((0.5 * std::hypot(tank.length, tank.width) + 0.5) / spacing);
    Scene scene = empty_site(side, side, spacing);
    const Turn turn(side / 2, side / 2, degrees);
    const double a = tank.length / 2, b = tank.width / 2;
    MapPolygon walls = turn.box(-a, a, -b, b);
    walls.rings.push_back({{-1, -1}, {side + 1, -1}, {side + 1, side + 1}, {-1, side + 1}});
    scene.site->houses = {house_of(walls)};
    for (const MapLine& corners : tank.houses) {
        MapLine ring;
        for (const MapPoint& p : corners) ring.push_back(turn(p.x, p.z));
        scene.site->houses.push_back(house_of({{ring}}));
    }
    const double slope_x = tank.slope * turn.cosine, slope_z = tank.slope * turn.sine;
    const MapPoint lowest = turn(-a, 0);
    scene.site->ground.slope_x = slope_x, scene.site->ground.slope_z = slope_z;
    scene.site->ground.level = -slope_x * lowest.x - slope_z * lowest.z;
    if (tank.ground) {
        scene.site->ground.raster = raster_of(side, side, spacing / 2, [&](double x, double z) {
            const MapPoint p = turn.back(x, z);
            return tank.ground(p.x, p.z);
        });
    }
    scene.site->water = {{{}, tank.level}};
    if (tank.filled < tank.length) scene.site->water[0].polygon = turn.box(-a - 1, -a + tank.filled, -b - 1, b + 1);
    scene.fluid = Fluid();
    scene.fluid->model = ModelKind::dfsph;
    scene.fluid->particle_spacing = spacing;
    scene.fluid->kinematic_viscosity = 0.01;
    const double most = tank.length * tank.width * (tank.level + spacing) / std::pow(spacing, 3);
    scene.fluid->max_particles = static_cast<int>(1.2 * most) + 100;
    if (tank.at_rest) scene.fluid->density_solve.tolerance = scene.fluid->divergence_solve.tolerance = 1e-4;
    scene.frame_rate = 30;
    return scene;
}

// The straight twin's particles, turned.
void lay_along(const Scene& straight, double degrees, fluid::FluidWorld& world) {
    const fluid::FluidWorld twin(straight);
    const double middle = straight.world->length / 2;
    const Turn turn(middle, middle, degrees);
    world.change_particles([&](fluid::Particles& p) {
        fluid::copy_particles(twin.particles(), p);
        for (std::size_t i = 0; i < p.count; ++i) {
            const MapPoint to = turn(static_cast<double>(p.x[i]) - middle, static_cast<double>(p.z[i]) - middle);
            p.x[i] = static_cast<float>(to.x), p.z[i] = static_cast<float>(to.z);
        }
    });
}

// What is measured of a run.
struct Measures {
    double rms_speed = 0, vertical_force = 0, contact = 0;  // means of the last second: m/s, over the weight
    double surface_drop = 0;                                // m, if the ground is level
    double mass = 0;                                        // of particles over that of the water, less 1
    double compression = 0, at_last = 0;                    // the largest of any particle, ever and in the last second
    double lost = 0;                                        // particles in walls, or put back out of them
    double centre = 0, way = 0;                             // of all water along the tank, and what it went, m
    double front = 0;                                       // at half a second, m
    // On the first house in the tank, along it and across: of all time, N s, and the largest mean over 0.1 s, N.
    double impulse = 0, side_impulse = 0, peak = 0;
    std::vector<double> depth;  // in squares of `square`, m
};

constexpr double front_at = 0.5;  // s: before it meets anything

void sample_depth(const Tank& tank, const fluid::Particles& p, const Turn& turn, double square, double volume,
                  std::vector<double>& depth) {
    const auto na = static_cast<std::size_t>(std::lround(tank.length / square));
    const auto nb = static_cast<std::size_t>(std::max(1L, std::lround(tank.width / square)));
    depth.assign(na * nb, 0);
    const double area = tank.length / static_cast<double>(na) * tank.width / static_cast<double>(nb);
    const auto cell = [](double share, std::size_t n) {
        return static_cast<std::size_t>(std::clamp(share * static_cast<double>(n), 0.0, static_cast<double>(n - 1)));
    };
    for (std::size_t i = 0; i < p.count; ++i) {
        const MapPoint at = turn.back(static_cast<double>(p.x[i]), static_cast<double>(p.z[i]));
        depth[cell(at.z / tank.width + 0.5, nb) * na + cell(at.x / tank.length + 0.5, na)] += volume / area;
    }
}

double along_tank(const fluid::Particles& p, const Turn& turn, double& front) {
    double sum = 0;
    front = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < p.count; ++i) {
        const double a = turn.back(static_cast<double>(p.x[i]), static_cast<double>(p.z[i])).x;
        sum += a;
        front = std::max(front, a);
    }
    return sum / static_cast<double>(p.count);
}

Measures measure(const Tank& tank, double degrees, bool along, const Request& request, Result& result, double square) {
    const double d = request.spacing;
    Scene scene = scene_of(tank, degrees, d);
    scene.world->gravity *= request.gravity_factor;
    fluid::FluidWorld world(scene);
    const double water = static_cast<double>(world.particles().count);
    if (along) lay_along(scene_of(tank, 0, d), degrees, world);
    const fluid::Particles& p = world.particles();
    const Turn turn(scene.world->length / 2, scene.world->width / 2, degrees);
    Measures m;
    const auto straight = static_cast<double>(fluid::FluidWorld(scene_of(tank, 0, d)).particles().count);
    m.mass = std::abs(water / straight - 1);
    double front = 0;
    const double began = along_tank(p, turn, front);
    const double weight =
        static_cast<double>(p.count) * static_cast<double>(world.particle_mass()) * scene.world->gravity;
    const int frames = frames_in(scene, tank.time), last = frames_in(scene, 1);
    Cost cost;
    double time = 0, squares = 0, height = 0, of_window = 0;
    const int window = frames_in(scene, 0.1);
    for (int f = 1; f <= frames; ++f) {
        const bool counts = f > frames - last;
        advance_frame(world, cost, [&](const fluid::StepReport& step) {
            if (!tank.at_rest && !tank.houses.empty()) {
                const std::array<double, 3> force = world.obstacle_force(1);
                const double along_it = turn.cosine * force[0] + turn.sine * force[2];
                m.impulse += along_it * step.dt, of_window += along_it * step.dt;
                m.side_impulse += (turn.cosine * force[2] - turn.sine * force[0]) * step.dt;
            }
            if (!counts) return;
            m.at_last = std::max(m.at_last, step.max_density_error);
            m.vertical_force += world.bed_pressure_force() * step.dt, m.contact += step.contact_force * step.dt;
            time += step.dt;
        });
        if (f % window == 0) m.peak = std::max(m.peak, std::exchange(of_window, 0.0) / 0.1);
        if (f == frames_in(scene, front_at)) along_tank(p, turn, m.front);
        for (std::size_t i = 0; counts && i < p.count; ++i) {
            squares += static_cast<double>(p.vx[i] * p.vx[i] + p.vy[i] * p.vy[i] + p.vz[i] * p.vz[i]);
            height += static_cast<double>(p.y[i]);
        }
    }
    const double counted = static_cast<double>(last) * static_cast<double>(p.count);
    m.rms_speed = std::sqrt(squares / counted);
    m.vertical_force = std::abs((m.vertical_force + m.contact) / time / weight - 1);
    m.contact /= time * weight;
    m.surface_drop = std::abs(tank.level - 2 * height / counted);
    m.compression = cost.max_density_error;
    for (std::size_t i = 0; i < p.count; ++i) m.lost += world.site()->is_water({p.x[i], p.y[i], p.z[i]}) ? 0 : 1;
    m.lost += static_cast<double>(world.position_clamps());
    m.centre = along_tank(p, turn, front);
    m.way = m.centre - began;
    sample_depth(tank, p, turn, square, std::pow(d, 3), m.depth);
    note_cost(cost, world, result);
    return m;
}

void note_worst(const std::string& name, double value, const std::string& unit, Result& result) {
    const auto at =
        std::find_if(result.metrics.begin(), result.metrics.end(), [&](const Metric& m) { return m.name == name; });
    if (at == result.metrics.end()) {
        result.metrics.push_back({name, value, unit});
    } else {
        at->value = std::max(at->value, value);
    }
}

// The worst of both angles.
Result run_at_rest(const Tank& tank, const Request& request) {
    Result result;
    for (const bool along : {true, false}) {
        const std::string lattice = along ? "_along" : "";
        for (const double degrees : angles) {
            const Measures m = measure(tank, degrees, along, request, result, 4 * request.spacing);
            note_worst("rms_speed" + lattice, m.rms_speed, "m/s", result);
            note_worst("vertical_force" + lattice, m.vertical_force, "1", result);
            note_worst("contact" + lattice, m.contact, "1", result);
            note_worst("compression" + lattice, m.at_last, "1", result);
            note_worst("compression_ever", m.compression, "1", result);
            note_worst("lost", m.lost, "1", result);
            note_worst("mass", m.mass, "1", result);
            if (tank.slope == 0 && !tank.ground) note_worst("surface_drop" + lattice, m.surface_drop, "m", result);
        }
    }
    return result;
}

Result run_moving(const Tank& tank, const Request& request, double square) {
    Result result;
    const Measures straight = measure(tank, 0, false, request, result, square);
    note_worst("compression", straight.compression, "1", result);
    note_worst("lost", straight.lost, "1", result);
    for (const bool along : {true, false}) {
        const std::string lattice = along ? "_along" : "";
        for (const double degrees : angles) {
            const Measures m = measure(tank, degrees, along, request, result, square);
            double l1 = 0;
            for (std::size_t n = 0; n < m.depth.size(); ++n) l1 += std::abs(m.depth[n] - straight.depth[n]);
            note_worst("depth_l1" + lattice, l1 / static_cast<double>(m.depth.size()) / tank.level, "1", result);
            note_worst("centre" + lattice, std::abs(m.centre - straight.centre) / straight.way, "1", result);
            note_worst("front" + lattice, std::abs(m.front - straight.front), "m", result);
            if (tank.houses.size() == 1) {
                note_worst("impulse" + lattice, std::abs(m.impulse / straight.impulse - 1), "1", result);
                note_worst("side_impulse" + lattice, std::abs(m.side_impulse / straight.impulse), "1", result);
                note_worst("peak" + lattice, std::abs(m.peak / straight.peak - 1), "1", result);
            }
            note_worst("compression", m.compression, "1", result);
            note_worst("lost", m.lost, "1", result);
            note_worst("mass", m.mass, "1", result);
        }
    }
    return result;
}

const MapLine block{{-0.3, -0.3}, {0.3, -0.3}, {0.3, 0.3}, {-0.3, 0.3}};
const MapLine block_in_the_way{{0.2, -0.3}, {0.8, -0.3}, {0.8, 0.3}, {0.2, 0.3}};
const MapLine l_shape{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0}, {0, 0}, {0, 0.5}, {-0.5, 0.5}};
// Houses in two rows on either side of a street 0.6 m wide, with lanes of 0.4 m between them.
const std::vector<MapLine> street_houses{{{0, 0.3}, {0.8, 0.3}, {0.8, 1.3}, {0, 1.3}},
                                         {{1.2, 0.3}, {1.8, 0.3}, {1.8, 1.3}, {1.2, 1.3}},
                                         {{0, -1.3}, {0.8, -1.3}, {0.8, -0.3}, {0, -0.3}},
                                         {{1.2, -1.3}, {1.8, -1.3}, {1.8, -0.3}, {1.2, -0.3}}};
const double ten_degrees = std::tan(std::numbers::pi / 18);

Result run_column(const Request& request) {
    return run_at_rest({}, request);
}
Result run_lake_house(const Request& request) {
    return run_at_rest({.length = 2.4, .width = 2.4, .houses = {block}, .time = 8}, request);
}
Result run_lake_l(const Request& request) {
    return run_at_rest({.length = 2.4, .width = 2.4, .houses = {l_shape}, .time = 8}, request);
}
Result run_shore(const Request& request) {
    return run_at_rest({.length = 4, .width = 0.8, .level = 0.6, .slope = ten_degrees, .time = 8}, request);
}
Result run_bumps(const Request& request) {
    const auto height = [](double a, double b) {
        return 0.15 * std::sin(std::numbers::pi * a / 1.2) * std::cos(std::numbers::pi * b / 1.2);
    };
    return run_at_rest({.length = 2.4, .width = 2.4, .ground = height, .time = 8}, request);
}
Result run_dam_break(const Request& request) {
    return run_moving({.length = 6, .width = 0.8, .filled = 2, .time = 1.2, .at_rest = false}, request,
                      2 * request.spacing);
}
Result run_block(const Request& request) {
    return run_moving({.length = 4.8,
                       .width = 2.4,
                       .level = 0.8,
                       .filled = 1.2,
                       .houses = {block_in_the_way},
                       .time = 2,
                       .at_rest = false},
                      request, 4 * request.spacing);
}
Result run_turned_street(const Request& request) {
    return run_moving({.length = 4.8,
                       .width = 2.4,
                       .level = 0.8,
                       .filled = 1.2,
                       .houses = street_houses,
                       .time = 2,
                       .at_rest = false},
                      request, 4 * request.spacing);
}

Case turned(const char* name, const char* truth, bool rests, Result (*run)(const Request&)) {
    return {.name = name, .truth = truth, .reference = rests ? "rest" : "straight twin", .spacings = {0.1}, .run = run};
}

}  // namespace

Case turned_column_case() {
    Case column = turned("turned_column", "A column of water 1 m deep rests between walls at 17 and 45 degrees.", true,
                         run_column);
    column.quick = true;
    return column;
}
Case turned_lake_house_case() {
    Case lake = turned("turned_lake_house", "A lake round a house rests, both turned by 17 and 45 degrees.", true,
                       run_lake_house);
    lake.starts = 5;
    return lake;
}
Case turned_lake_l_case() {
    return turned("turned_lake_l", "A lake round a house like an L rests, both turned by 17 and 45 degrees.", true,
                  run_lake_l);
}
Case turned_shore_case() {
    return turned("turned_shore", "Water rests at a shore of 10 degrees that is turned in plan by 17 and 45 degrees.",
                  true, run_shore);
}
Case turned_bumps_case() {
    return turned("turned_bumps",
                  "Water rests over bumps 0.3 m high and 2.4 m long between walls at 17 and 45 degrees.", true,
                  run_bumps);
}
Case turned_dam_break_case() {
    return turned("turned_dam_break",
                  "A dam break in a channel turned by 17 and 45 degrees does what it does in the straight one.", false,
                  run_dam_break);
}
Case turned_block_case() {
    return turned("turned_block",
                  "A dam break against a house, both turned by 17 and 45 degrees, does what it does straight.", false,
                  run_block);
}
Case turned_street_case() {
    Case street = turned(
        "turned_street",
        "A dam break through a street between four houses, turned by 17 and 45 degrees, does what it does straight.",
        false, run_turned_street);
    street.starts = 5;
    return street;
}

}  // namespace wade::validation
