// The crowd without water.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include "cases.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"
#include "crowd_route.hpp"
#include "crowd_run.hpp"

namespace wade::validation {
namespace {

// People without others near them walk at their desired speed.

// |m| of Eq. 1 in the middle of a full disc of 1 m radius for evenly spread markers, m; see tests/unit of the crowd.
const double free_motion = (std::log(2.0) - 0.5) / (2 * (1 - std::log(2.0)));

// Mean progress along x over `time` seconds, m/s.
double mean_speed(Scene scene, SpeedRule rule, double time, Result& result) {
    scene.crowd->speed_rule = rule;
    crowd::CrowdWorld crowd = crowd::make_crowd(scene);
    double start = 0;
    for (std::size_t id = 0; id < crowd.agents.size(); ++id) start += unrolled_x(crowd, id);
    while (static_cast<double>(crowd.steps) * crowd.dt < time - crowd.dt / 2) walk(crowd, result);
    double end = 0;
    for (std::size_t id = 0; id < crowd.agents.size(); ++id) end += unrolled_x(crowd, id);
    return (end - start) / static_cast<double>(crowd.agents.size()) / time;
}

Result run_free_speed(const Request& request) {
    const Scene scene = crowd_scene(request, "validation/crowd_free.json");
    const double desired = scene.crowd->groups.at(0).desired_speed;
    Result result = crowd_result();
    const double pi = mean_speed(scene, SpeedRule::pi, scene.duration, result);
    const double per_frame = mean_speed(scene, SpeedRule::per_frame, scene.duration, result);
    const double per_second = mean_speed(scene, SpeedRule::per_second, scene.duration, result);
    const double closed_form = std::min(std::acos(-1.0) * free_motion, 1.0) * desired;
    result.metrics = {
        {"speed_error_pi", std::abs(pi / desired - 1), "1"},
        {"speed_error_per_frame", std::abs(per_frame / desired - 1), "1"},
        {"closed_form_error_pi", std::abs(pi / closed_form - 1), "1"},
        {"closed_form_error_per_second", std::abs(per_second / free_motion - 1), "1"},
        {"speed_pi", pi, "m/s"},
        {"speed_per_frame", per_frame, "m/s"},
        {"speed_per_second", per_second, "m/s"},
    };
    return result;
}

// The mirrored scene gives the mirrored run.

// A multiple of 2^-20 m, so that mirrored coordinates and their differences are exact.
double rounded(double v) {
    return std::ldexp(std::round(std::ldexp(v, 20)), -20);
}

struct Mirror {
    bool along_x = false;
    bool along_z = false;
    double length = 0, width = 0;  // of the world, m

    [[nodiscard]] crowd::Vector2d operator()(const crowd::Vector2d& p) const {
        return {along_x ? length - p.x() : p.x(), along_z ? width - p.y() : p.y()};
    }
};

// The markers within 2 m of the world, rounded and mirrored. The last rows and columns of the grid's border lie farther
// away than the first; no agent perceives markers there.
crowd::Markers mirrored(const crowd::Markers& markers, const Mirror& mirror) {
    crowd::Markers made;
    made.grid = markers.grid;
    std::vector<std::pair<std::size_t, crowd::Vector2d>> kept;
    for (std::size_t m = 0; m < markers.size(); ++m) {
        const crowd::Vector2d p(rounded(markers.x[m]), rounded(markers.z[m]));
        if (p.x() <= -2 || p.y() <= -2 || p.x() >= mirror.length + 2 || p.y() >= mirror.width + 2) continue;
        const crowd::Vector2d q = mirror(p);
        kept.emplace_back(made.grid.cell_of(q.x(), q.y()), q);
    }
    std::stable_sort(kept.begin(), kept.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    made.cell_start.assign(made.grid.cells() + 1, 0);
    for (const auto& [cell, p] : kept) {
        made.x.push_back(p.x());
        made.z.push_back(p.y());
        ++made.cell_start[cell + 1];
    }
    for (std::size_t c = 0; c < made.grid.cells(); ++c) made.cell_start[c + 1] += made.cell_start[c];
    return made;
}

crowd::CrowdWorld mirrored_crowd(Scene scene, const crowd::Markers& markers, const Mirror& mirror) {
    for (Obstacle& o : scene.obstacles) {
        if (mirror.along_x) o.x = {mirror.length - o.x.hi, mirror.length - o.x.lo};
        if (mirror.along_z) o.z = {mirror.width - o.z.hi, mirror.width - o.z.lo};
    }
    crowd::CrowdWorld crowd = crowd::make_crowd(scene);
    crowd.markers = mirrored(markers, mirror);
    for (std::size_t id = 0; id < crowd.agents.size(); ++id) {
        crowd.agents.position[id] = mirror(crowd.agents.position[id]);
        crowd.agents.goal[id] = mirror(crowd.agents.goal[id]);
    }
    return crowd;
}

Result run_mirror(const Request& request) {
    const Scene scene = crowd_scene(request, "validation/crowd_mirror.json");
    const crowd::Markers markers = crowd::make_crowd(scene).markers;
    const Mirror none{false, false, scene.world->length, scene.world->width};
    crowd::CrowdWorld reference = mirrored_crowd(scene, markers, none);
    Mirror in_z = none;
    in_z.along_z = true;
    Mirror in_x = none;
    in_x.along_x = true;
    crowd::CrowdWorld over_z = mirrored_crowd(scene, markers, in_z);
    crowd::CrowdWorld over_x = mirrored_crowd(scene, markers, in_x);

    Result result = crowd_result();
    double distance_z = 0;
    double distance_x = 0;
    while (!reference.active.empty() && static_cast<double>(reference.steps) * reference.dt < scene.duration) {
        walk(reference, result);
        walk(over_z, result);
        walk(over_x, result);
        for (std::size_t id = 0; id < reference.agents.size(); ++id) {
            const crowd::Vector2d& p = reference.agents.position[id];
            distance_z = std::max(distance_z, (in_z(over_z.agents.position[id]) - p).norm());
            distance_x = std::max(distance_x, (in_x(over_x.agents.position[id]) - p).norm());
        }
    }
    double other_ends = 0;
    for (std::size_t id = 0; id < reference.agents.size(); ++id) {
        const bool same = reference.agents.outcome[id] == over_z.agents.outcome[id] &&
                          reference.agents.outcome[id] == over_x.agents.outcome[id] &&
                          reference.agents.end_step[id] == over_z.agents.end_step[id] &&
                          reference.agents.end_step[id] == over_x.agents.end_step[id];
        other_ends += same ? 0 : 1;
    }
    result.metrics = {
        {"distance_mirrored_in_z", distance_z, "m"},
        {"distance_mirrored_in_x", distance_x, "m"},
        {"other_ends", other_ends, "1"},
        {"arrived", static_cast<double>(reference.arrived), "1"},
    };
    return result;
}

// People with bodies in the corridor without ends: speed over density, counterflow, and that no two overlap.

constexpr double settling = 30;   // s
constexpr double measuring = 60;  // s

// Mean speed of the people in the direction that they want, m/s.
double speed_at(const Request& request, double density, bool two_ways, Result& result, Overlaps& overlaps,
                const Interval& across = corridor_z) {
    crowd::CrowdWorld crowd = corridor_crowd(request, SpeedRule::pi, density, two_ways, across);
    mean_progress(crowd, settling, result, overlaps);
    return mean_progress(crowd, measuring, result, overlaps);
}

std::string percent(double density) {
    char text[8];
    std::snprintf(text, sizeof text, "%03.0f", 100 * density);
    return text;
}

// Speeds measured in a corridor 1.8 m wide, m/s, by density, 1/m2: runs uo-*-180-180 and uo-180-180-* of the HERMES
// experiments (J. Zhang et al., J. Stat. Mech. (2011) P06004; trajectories of Forschungszentrum Juelich). Mean number and
// mean speed over 1 s of the people in the 4 m in the middle of the corridor, from the first to the third quartile in time.
const std::vector<std::pair<double, double>> hermes{{0.48, 1.337}, {0.54, 1.377}, {0.61, 1.336},
                                                    {1.15, 1.161}, {1.64, 0.964}, {1.67, 0.951},
                                                    {2.11, 0.603}, {2.48, 0.410}, {2.99, 0.291}};

// Compares people with bodies in a corridor of that width with these speeds and with Weidmann's at the same densities.
Curve narrow_corridor(const Request& request, Result& result, Overlaps& overlaps) {
    constexpr Interval across{4.1, 5.9};
    Curve speeds{
        "speed_in_narrow_corridor_m_s", {"density_per_m2", "human", "measured_Zhang_2011", "exact_Weidmann"}, {}};
    double over_measured = 0, over_weidmann = 0;
    for (const auto& [density, measured] : hermes) {
        const double speed = speed_at(request, density, false, result, overlaps, across);
        speeds.rows.push_back({density, speed, measured, weidmann_speed(density)});
        over_measured += (speed - measured) / static_cast<double>(hermes.size());
        over_weidmann += (speed - weidmann_speed(density)) / static_cast<double>(hermes.size());
    }
    result.metrics.push_back({"narrow_bias_measured", std::abs(over_measured), "m/s"});
    result.metrics.push_back({"narrow_bias_weidmann", std::abs(over_weidmann), "m/s"});
    return speeds;
}

Result run_bodies(const Request& request) {
    const std::vector<double> densities{0.5, 1, 2, 3};
    Result result = crowd_result();
    Curve speeds{"speed_by_density_m_s", {"density_per_m2", "human", "exact_Weidmann", "fast"}, {}};
    for (const double rho : densities) speeds.rows.push_back({rho, 0, weidmann_speed(rho), 0});
    for (const auto& [style, column] : {std::pair{"human", 1}, std::pair{"fast", 3}}) {
        Request with_bodies = request;
        with_bodies.overrides.push_back(std::string("/crowd/bodies=") + style);
        with_bodies.overrides.push_back("/crowd/markers=redrawn");
        Overlaps overlaps;
        double largest = 0;  // difference from Weidmann's curve
        for (std::vector<double>& row : speeds.rows) {
            const double speed = speed_at(with_bodies, row[0], false, result, overlaps);
            row[static_cast<std::size_t>(column)] = speed;
            largest = std::max(largest, std::abs(speed - row[2]));
        }
        result.metrics.push_back({std::string("weidmann_largest_difference_") + style, largest, "m/s"});
        for (const double rho : {0.5, 1.0}) {
            result.metrics.push_back({std::string("counterflow_speed_") + style + "_" + percent(rho),
                                      speed_at(with_bodies, rho, true, result, overlaps), "m/s"});
        }
        if (column == 1) result.curves.push_back(narrow_corridor(with_bodies, result, overlaps));
        report_overlaps(overlaps, std::string("_") + style, result);
    }
    result.curves.insert(result.curves.begin(), speeds);
    return result;
}

// Fifty people on a circle, each wants to the opposite side.

// Sets of markers, each a run of its own: whether a crowd jams is a matter of chance.
constexpr std::uint64_t seed_count = 5;

Scene circle_scene(const Request& request, SpeedRule rule) {
    Scene scene = crowd_scene(request, "validation/crowd_circle.json");
    scene.crowd->speed_rule = rule;
    constexpr int people = 50;
    constexpr double radius = 10;  // m
    const double centre = scene.world->length / 2;
    for (int k = 0; k < people; ++k) {
        const double angle = 2 * std::numbers::pi * k / people;
        AgentGroup group;
        group.name = "person_" + std::to_string(k);
        group.start_x = centre + radius * std::cos(angle);
        group.start_z = centre + radius * std::sin(angle);
        group.goal_x = 2 * centre - group.start_x;
        group.goal_z = 2 * centre - group.start_z;
        group.desired_speed = 1.34;
        scene.crowd->groups.push_back(group);
    }
    return scene;
}

void measure(const Request& request, SpeedRule rule, const std::string& suffix, Result& result) {
    Scene scene = circle_scene(request, rule);
    const double ideal = (20 - scene.crowd->goal_radius) / scene.crowd->groups.at(0).desired_speed;
    const auto people = static_cast<double>(scene.crowd->groups.size());
    Overlaps overlaps;
    double worst = 0;
    double arrived = 0;
    double time = 0;  // sum over arrived agents, s
    double last = 0;  // s
    const std::uint64_t first_seed = scene.seed;
    for (std::uint64_t run = 0; run < seed_count; ++run) {
        scene.seed = first_seed + run;
        crowd::CrowdWorld crowd = crowd::make_crowd(scene);
        while (!crowd.active.empty() && static_cast<double>(crowd.steps) * crowd.dt < scene.duration) {
            walk(crowd, result);
            if (crowd.steps % 10 == 0) note_overlaps(crowd, overlaps);
        }
        for (std::size_t id = 0; id < crowd.agents.size(); ++id) {
            if (crowd.agents.outcome[id] != crowd::Outcome::arrived) continue;
            time += static_cast<double>(crowd.agents.end_step[id]) * crowd.dt;
        }
        worst = std::max(worst, static_cast<double>(crowd.active.size()));
        arrived += static_cast<double>(crowd.arrived);
        last = std::max(last, static_cast<double>(crowd.last_arrival_step) * crowd.dt);
    }
    result.metrics.push_back({"left_behind" + suffix, worst, "1"});
    result.metrics.push_back({"arrived_share" + suffix, arrived / people / static_cast<double>(seed_count), "1"});
    result.metrics.push_back({"mean_time" + suffix, time / arrived / ideal, "1"});
    result.metrics.push_back({"last_time" + suffix, last / ideal, "1"});
    report_overlaps(overlaps, suffix, result);
}

Result run_circle(const Request& request) {
    Result result = crowd_result();
    measure(request, SpeedRule::pi, "_pi", result);
    measure(request, SpeedRule::per_frame, "_per_frame", result);
    return result;
}

// Two streams meet in a corridor: do lanes form, or does the crowd stop?

constexpr double window = 10;  // s
constexpr int windows = 12;

// Order of lanes, 0 mixed to 1 separated: the mean of ((same - opposite) / (same + opposite))^2 over all agents, where
// the others within 3/4 of rho^-1/2 across the corridor count. M. Rex, H. Loewen, Phys. Rev. E 75, 051402 (2007).
double lane_order(const crowd::CrowdWorld& crowd, double density) {
    const double reach = 0.75 / std::sqrt(density);
    double sum = 0;
    for (const std::uint32_t i : crowd.active) {
        double same = 0;
        double opposite = 0;
        for (const std::uint32_t j : crowd.active) {
            if (std::abs(crowd.agents.position[i].y() - crowd.agents.position[j].y()) > reach || i == j) continue;
            (crowd.agents.goal[i].x() * crowd.agents.goal[j].x() > 0 ? same : opposite) += 1;
        }
        const double all = same + opposite;
        sum += all > 0 ? std::pow((same - opposite) / all, 2) : 0;
    }
    return sum / static_cast<double>(crowd.active.size());
}

// Returns the fraction of people that move at less than a tenth of their desired speed.
double stuck_share(const crowd::CrowdWorld& crowd) {
    double stuck = 0;
    for (const std::uint32_t id : crowd.active) {
        stuck += crowd.agents.velocity[id].norm() < 0.1 * crowd.agents.desired_speed[id] ? 1 : 0;
    }
    return stuck / static_cast<double>(crowd.active.size());
}

Result run_counterflow(const Request& request) {
    Result result = crowd_result();
    struct Setting {
        SpeedRule rule;
        const char* name;
    };
    for (const Setting& setting : {Setting{SpeedRule::pi, "pi"}, Setting{SpeedRule::per_frame, "per_frame"}}) {
        const std::string rule = setting.name;
        Curve speed{"speed_" + rule, {"time_s"}, {}};
        Curve order{"lane_order_" + rule, {"time_s"}, {}};
        for (int w = 0; w < windows; ++w) {
            speed.rows.push_back({(w + 1) * window});
            order.rows.push_back({(w + 1) * window});
        }
        for (const auto& [density, label] : {std::pair{0.25, "025"}, std::pair{0.5, "050"}, std::pair{1.0, "100"}}) {
            crowd::CrowdWorld crowd = corridor_crowd(request, setting.rule, density, true);
            const double mixed = lane_order(crowd, density);
            Overlaps overlaps;
            double last = 0;
            double lanes = 0;
            const bool drawn = density >= 0.5;
            if (drawn) {
                const std::string people = density < 1 ? "_at_half_a_person_m2" : "_at_one_person_m2";
                speed.columns.push_back("speed_" + rule + people + "_m_s");
                order.columns.push_back("lane_order_" + rule + people);
            }
            for (std::size_t w = 0; w < windows; ++w) {
                last = mean_progress(crowd, window, result, overlaps);
                lanes = lane_order(crowd, density);
                if (!drawn) continue;
                speed.rows[w].push_back(last);
                order.rows[w].push_back(lanes);
            }
            const std::string suffix = "_" + rule + "_" + label;
            result.metrics.push_back({"flow" + suffix, density * last, "1/(m s)"});
            result.metrics.push_back({"speed" + suffix, last, "m/s"});
            result.metrics.push_back({"lane_order" + suffix, lanes, "1"});
            result.metrics.push_back({"lane_order_at_start" + suffix, mixed, "1"});
            result.metrics.push_back({"stuck_share" + suffix, stuck_share(crowd), "1"});
            report_overlaps(overlaps, suffix, result);
        }
        result.curves.push_back(speed);
        result.curves.push_back(order);
    }
    return result;
}

}  // namespace

Case crowd_free_speed_case() {
    return {.name = "crowd_free_speed",
            .truth =
                "People who meet nobody progress at their desired speed of 1.34 m/s (Weidmann 1993) with the speed "
                "rules pi and per_frame; with per_second Eq. 1-4 give 0.3147 m/s in closed form, and with pi 0.989 of "
                "the desired speed. Levels: 16, 32 and 64 markers per m2; spacing is their mean distance.",
            .reference = "desired speed",
            .spacings = marker_spacings,
            .quick = true,
            .run = run_free_speed};
}

Case crowd_mirror_case() {
    return {.name = "crowd_mirror",
            .truth =
                "Two groups of 24 cross, one past a block, and again with everything mirrored across and along "
                "the world, markers too: the paths must be mirror images. Levels: 16, 32 and 64 markers per m2.",
            .reference = "mirror image",
            .spacings = marker_spacings,
            .quick = true,
            .run = run_mirror};
}

Case crowd_bodies_case() {
    return {.name = "crowd_bodies",
            .truth =
                "people with bodies of 0.25 m radius in a corridor 8 m wide that repeats after 20 m, beside Weidmann "
                "1993: v = 1.34 (1 - exp(-1.913 (1/rho - 1/5.4))) m/s, at 0.5, 1, 2 and 3 people/m2. Means of 60 s "
                "after 30 s. The same 1.8 m wide (`narrow`), beside nine measured speeds of Zhang et al. 2011: mean "
                "difference over the nine densities of 0.48 to 2.99 people/m2. Half of the people the other way in the "
                "counterflow. No two may overlap.",
            .reference = "Weidmann 1993",
            .spacings = {0.25, 2.0 / 11, 0.125},  // redrawn markers come in squares: 64, 121 and 256 a cell
            .quick = true,
            .run = run_bodies};
}

Case crowd_circle_case() {
    return {.name = "crowd_circle",
            .truth =
                "Fifty people on a circle of 10 m radius walk to the opposite side; all must get there within "
                "300 s, with each of five sets of markers (left_behind: the worst). Times over that of one who meets "
                "nobody, 14.6 s. Levels: 16, 32 and 64 markers per m2.",
            .reference = "all arrive",
            .spacings = marker_spacings,
            .run = run_circle};
}

Case crowd_counterflow_case() {
    return {.name = "crowd_counterflow",
            .truth =
                "Half of the people in a corridor walk one way, half the other, 120 s. Real people form lanes "
                "(order parameter of Rex and Loewen 2007, 0 mixed to 1 separated) and keep walking. Flow and speed "
                "of the last 10 s, at 0.25, 0.5 and 1 per m2. Levels: 16, 32 and 64 markers per m2.",
            .reference = "lanes form",
            .spacings = marker_spacings,
            .run = run_counterflow};
}

}  // namespace wade::validation
