// Water that is let go.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "cases.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/world.hpp"
#include "dam_break.hpp"
#include "profiles.hpp"
#include "run.hpp"
#include "shallow_water_exact.hpp"
#include "slice.hpp"

namespace wade::validation {
namespace {

// Ritter (1892): a dam breaks over a dry, smooth bed.

Result run_dam_break(const Request& request) {
    const Scene scene = scene_for(request, "validation/dam_break.json", slice_sizes(request, 1));
    const std::unique_ptr<Water> water = make_water(scene);
    const WaterBlock& reservoir = scene.channel->water_blocks.at(0);
    const double g = scene.world->gravity;
    const DamBreak dam{scene, reservoir.x.lo, reservoir.depth,
                       [&](double s, double t) { return ritter(s, t, reservoir.depth, g); }};
    Result result;
    Cost cost;
    Curve profile;
    Curve tip{"tip", {"t_s", "tip_m", "exact_tip_m"}, {}};
    const DamBreakErrors errors = run_dam_break(dam, *water, cost, profile, [&](double t, double, const Columns&) {
        const double reached = reservoir.x.lo - water->front(reservoir.x.hi);
        tip.rows.push_back({t, reached, 2 * std::sqrt(g * reservoir.depth) * t});
    });
    water->note(cost, result);
    result.metrics = {
        {"depth_l1", errors.depth, "1"},
        {"speed_l1", errors.speed, "1"},
        {"depth_l1_last", errors.last_depth, "1"},
        {"tip_lag", 1 - tip.rows.back()[1] / tip.rows.back()[2], "1"},
        {"max_density_error", cost.max_density_error, "1"},
        {"position_clamps", water->position_clamps(), "1"},
    };
    result.curves = {profile, tip};
    return result;
}

// Stoker (1957): a dam breaks over a bed under water, and a shock runs ahead.

constexpr double first_shock = 6;  // t sqrt(g/H) after which the shock's position is compared

// Returns the position of the shock, m downstream of the dam: where the depth, seen from downstream, first exceeds
// `threshold`, the mean of the depths before and behind the shock. Linear between columns; NaN if there is none.
double shock_place(const Columns& columns, double dam_x, double threshold) {
    double before = columns.depth(0);
    for (std::size_t k = 1; k < columns.count(); ++k) {
        const double depth = columns.depth(k);
        if (depth >= threshold && before < threshold) {
            const double part = (threshold - before) / (depth - before);
            return dam_x - (columns.centre(k - 1) + part * columns.length());
        }
        before = depth;
    }
    return std::numeric_limits<double>::quiet_NaN();
}

// The same dam by Serre's equations, which know how waves disperse.
struct DispersiveTwin {
    SerreWaves waves;
    double time = 0;  // s
    Columns columns;  // of that time
};

DispersiveTwin make_twin(const DamBreak& dam, double tail) {
    const Interval& x = dam.scene.channel->x;
    const double cell = 0.02 * dam.depth;  // half of it moves the bore by less than a thousandth
    const auto depth = [&](double from_start) {
        // The dam is a slope as steep as some cells allow.
        const double step = std::tanh((x.lo + from_start - dam.dam_x) / (3 * cell));
        return (dam.depth + tail) / 2 + (dam.depth - tail) / 2 * step;
    };
    return {serre_waves(x.length(), cell, dam.scene.world->gravity, depth, [](double) { return 0.0; }), 0, {}};
}

// To time t, in columns as those of the case.
void advance_to(DispersiveTwin& twin, double t, const Columns& of_case) {
    advance(twin.waves, t - twin.time);
    twin.time = t;
    Columns& columns = twin.columns;
    columns = make_columns(of_case.x, of_case.width, of_case.length());
    columns.samples = 1;
    const std::vector<double> u = velocities(twin.waves);
    for (std::size_t i = 0; i < u.size(); ++i) {
        const double place = (static_cast<double>(i) + 0.5) * twin.waves.dx / columns.length();
        const auto k = std::min(static_cast<std::size_t>(place), columns.count() - 1);
        const double volume = twin.waves.depth[i] * twin.waves.dx * columns.width;
        columns.volume[k] += volume;
        columns.momentum[k] += volume * u[i];
    }
}

// Updates the worst error of the shock's distance from the dam, relative to the exact distance; NaN without a shock.
void note_shock(double& worst, double place, double truth) {
    const double error = std::abs(place / truth - 1);
    worst = std::isnan(error) ? error : std::max(worst, error);
}

// Depths and velocities of the twin beside those of the last frame, from upstream on as in run_dam_break().
void add_twin(Curve& profile, const Columns& twin) {
    profile.columns.insert(profile.columns.end(), {"reference_depth_m", "reference_velocity_m_s"});
    for (std::size_t r = 0; r < profile.rows.size(); ++r) {
        const std::size_t k = profile.rows.size() - 1 - r;
        profile.rows[r].insert(profile.rows[r].end(), {twin.depth(k), -twin.velocity(k)});
    }
}

Result run_wet_bed(const Request& request, const char* name, bool is_undular) {
    const Scene scene = scene_for(request, name, slice_sizes(request, 2));
    const std::unique_ptr<Water> water = make_water(scene);
    const WaterBlock& reservoir = scene.channel->water_blocks.at(0);
    const WaterBlock& tail = scene.channel->water_blocks.at(1);
    const WetDamBreak exact = solve_wet_dam_break(reservoir.depth, tail.depth, scene.world->gravity);
    const DamBreak dam{scene, reservoir.x.lo, reservoir.depth, [&](double s, double t) { return stoker(exact, s, t); }};
    check_duration(dam, first_shock);
    const bool knows_dispersion = scene.fluid->model != ModelKind::shallow_water;
    std::optional<DispersiveTwin> twin;
    if (is_undular && knows_dispersion) twin = make_twin(dam, tail.depth);
    Result result;
    Cost cost;
    Curve profile;
    Curve shock{"shock", {"t_s", "shock_m", "exact_shock_m"}, {}};
    if (twin) shock.columns.emplace_back("reference_shock_m");
    double worst = 0, worst_dispersive = 0;
    const double threshold = (exact.h_middle + exact.h_right) / 2;
    const DamBreakErrors errors =
        run_dam_break(dam, *water, cost, profile, [&](double t, double scaled, const Columns& c) {
            const double place = shock_place(c, dam.dam_x, threshold);
            const double truth = exact.shock_speed * t;
            shock.rows.push_back({t, place, truth});
            if (scaled >= first_shock) note_shock(worst, place, truth);
            if (!twin) return;
            advance_to(*twin, t, c);
            const double dispersive = shock_place(twin->columns, dam.dam_x, threshold);
            shock.rows.back().push_back(dispersive);
            if (scaled >= first_shock) note_shock(worst_dispersive, place, dispersive);
        });
    water->note(cost, result);
    result.metrics = {
        {"depth_l1", errors.depth, "1"},
        {"speed_l1", errors.speed, "1"},
        {"shock_place", worst, "1"},
    };
    if (twin) {
        result.metrics.push_back({"shock_place_dispersive", worst_dispersive, "1"});
        add_twin(profile, twin->columns);
    }
    if (!knows_dispersion) result.not_judged = {"shock_place_dispersive"};
    result.metrics.insert(result.metrics.end(), {{"depth_l1_last", errors.last_depth, "1"},
                                                 {"max_density_error", cost.max_density_error, "1"},
                                                 {"position_clamps", water->position_clamps(), "1"}});
    result.curves = {profile, shock};
    return result;
}

Case wet_bed_case(const char* name, const char* ratio) {
    return {
        .name = name,
        .truth = std::string("Dam break over water at rest, h_r/h_l = ") + ratio +
                 ", Stoker (1957). Depth and velocity as for the dry bed; shock_place: the worst distance of the shock "
                 "from its place, of the way that it has made, t sqrt(g/H) = 6 to 8. The exact shock is a step; real "
                 "water, and these particles, make it a bore some depths long.",
        .reference = "Stoker 1957",
        .starts = 5};
}

// Martin and Moyce (1952): a column of water collapses over a dry, level bed.

// Phil. Trans. R. Soc. A 244, 312 (1952), square column n^2 = 2 (twice as high as wide), a = 2.25 in:
// T = t sqrt(2 g / a), Z = front / a, from the wall behind the column.
constexpr std::array<std::pair<double, double>, 18> measured{{{0.41, 1.11},
                                                              {0.84, 1.22},
                                                              {1.19, 1.44},
                                                              {1.43, 1.67},
                                                              {1.63, 1.89},
                                                              {1.83, 2.11},
                                                              {1.98, 2.33},
                                                              {2.20, 2.56},
                                                              {2.32, 2.78},
                                                              {2.51, 3.00},
                                                              {2.65, 3.22},
                                                              {2.83, 3.44},
                                                              {2.97, 3.67},
                                                              {3.11, 3.89},
                                                              {3.33, 4.11},
                                                              {4.02, 5.00},
                                                              {4.44, 6.00},
                                                              {5.09, 7.00}}};
constexpr double last_compared = 3.3;  // T; later the two series of the experiment scatter by as much as the threshold

struct Point {
    double time = 0, front = 0;  // T, Z
};

double front_at(const std::vector<Point>& points, double time) {
    if (time <= 0) {
        return points[0].front;
    }
    for (std::size_t i = 1; i < points.size(); ++i) {
        if (points[i].time >= time) {
            const double part = (time - points[i - 1].time) / (points[i].time - points[i - 1].time);
            return points[i - 1].front + part * (points[i].front - points[i - 1].front);
        }
    }
    return std::numeric_limits<double>::quiet_NaN();
}

struct Errors {
    double rms = 0, mean = 0;  // relative to the measured front
};

// Of the simulation that starts `delay` later, T.
Errors errors_with(const std::vector<Point>& simulated, double delay) {
    Errors errors;
    int compared = 0;
    for (const auto& [time, z] : measured) {
        if (time <= last_compared) {
            const double error = front_at(simulated, time - delay) / z - 1;
            errors.rms += error * error;
            errors.mean += error;
            ++compared;
        }
    }
    return {std::sqrt(errors.rms / compared), errors.mean / compared};
}

Result run_collapse(const Request& request) {
    const Scene scene = scene_for(request, "validation/collapse.json", slice_sizes(request, 1));
    fluid::FluidWorld world(scene);
    const WaterBlock& column = scene.channel->water_blocks.at(0);
    const double a = column.x.length();
    const double unit = std::sqrt(a / (2 * scene.world->gravity));  // of T, s
    const double d = scene.fluid->particle_spacing;
    // The front is the far edge of the foremost particle, half a spacing ahead of its centre: a at t = 0.
    const auto front = [&] { return (column.x.hi - leading_x(world.particles(), column.x.hi) + d / 2) / a; };

    std::vector<Point> simulated{{0, front()}};
    Cost cost;
    const int frames = frames_in(scene, scene.duration);
    for (int f = 1; f <= frames; ++f) {
        advance_frame(world, cost);
        simulated.push_back({f / scene.frame_rate / unit, front()});
    }

    Result result;
    note_cost(cost, world, result);
    Curve curve{"front", {"T", "Z", "measured_Z"}, {}};
    const double nothing = std::numeric_limits<double>::quiet_NaN();
    for (const Point& point : simulated) {
        curve.rows.push_back({point.time, point.front, nothing});
    }
    for (const auto& [time, z] : measured) {
        if (time <= last_compared) {
            curve.rows.push_back({time, nothing, z});
        }
    }
    const Errors errors = errors_with(simulated, 0);
    double delay = 0;
    for (double other = -0.5; other <= 0.5; other += 0.01) {
        delay = errors_with(simulated, other).rms < errors_with(simulated, delay).rms ? other : delay;
    }
    result.metrics = {
        {"front_rms", errors.rms, "1"},
        {"front_mean_lead", errors.mean, "1"},
        {"front_rms_delayed", errors_with(simulated, delay).rms, "1"},
        {"delay", delay, "T"},
        {"max_density_error", cost.max_density_error, "1"},
        {"position_clamps", static_cast<double>(world.position_clamps()), "1"},
    };
    result.curves = {curve};
    return result;
}

}  // namespace

Case dam_break_case() {
    return {
        .name = "dam_break",
        .truth =
            "Dam break over a dry bed without friction, Ritter (1892). The worst frame of t sqrt(g/H) = 4 to 8: L1 of "
            "the depth over H and of the mean velocity over sqrt(g H), by columns of H/5, where the exact depth is "
            "above 0.15 H. tip_lag: how far the foremost particle is behind Ritter's front, of the way that the "
            "front has made.",
        .reference = "Ritter 1892",
        .spacings = {0.1, 0.05, 0.025},
        .quick = true,
        .run = run_dam_break};
}

Case wet_bed_01_case() {
    Case c = wet_bed_case("wet_bed_01", "0.1 (only where h_r has four layers of particles)");
    c.spacings = {0.025};
    c.run = [](const Request& request) { return run_wet_bed(request, "validation/wet_bed_01.json", false); };
    return c;
}

Case wet_bed_02_case() {
    Case c = wet_bed_case("wet_bed_02", "0.2");
    c.spacings = {0.1, 0.05, 0.025};
    c.quick = true;
    c.run = [](const Request& request) { return run_wet_bed(request, "validation/wet_bed_02.json", false); };
    return c;
}

Case wet_bed_05_case() {
    Case c = wet_bed_case("wet_bed_05", "0.5");
    c.truth +=
        " This one is low enough for an undular bore: shock_place_dispersive compares its place with that of the same "
        "dam by Serre's equations (1953), the dashed line, which know how waves disperse but not that they break.";
    c.spacings = {0.1, 0.05, 0.025};
    c.quick = true;
    c.run = [](const Request& request) { return run_wet_bed(request, "validation/wet_bed_05.json", true); };
    return c;
}

Case collapse_case() {
    const double a = 0.05715;  // m, 2.25 in
    return {
        .name = "collapse",
        .truth =
            "Collapse of a column of water 2.25 in (a) wide and twice as high, Martin and Moyce (1952): the front Z = "
            "x/a at 14 times T = t sqrt(2 g/a) up to 3.3, RMS of the relative errors. front_mean_lead: their mean, "
            "positive if the simulated front is ahead. Friction of the bed and the time that the gate takes are not "
            "simulated.",
        .reference = "Martin and Moyce 1952",
        .spacings = {a / 10, a / 20, a / 40},
        .quick = true,
        .run = run_collapse};
}

}  // namespace wade::validation
