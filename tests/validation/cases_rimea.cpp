// Tests of the RiMEA guideline.

#include <algorithm>
#include <cmath>
#include <limits>

#include "cases.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/obstacle.hpp"
#include "crowd_route.hpp"
#include "crowd_run.hpp"

namespace wade::validation {
namespace {

// RiMEA test 1: a person in a corridor keeps the speed that it is given.
Result run_rimea_01(const Request& request) {
    const Scene scene = crowd_scene(request, "validation/crowd_rimea_01.json");
    crowd::CrowdWorld crowd = crowd::make_crowd(scene);
    constexpr double way = 40;  // m
    const double start = crowd.agents.position[0].x();
    const double desired = crowd.agents.desired_speed[0];
    double time = std::numeric_limits<double>::quiet_NaN();
    Result result = crowd_result();
    while (!crowd.active.empty() && static_cast<double>(crowd.steps) * crowd.dt < scene.duration) {
        const double before = crowd.agents.position[0].x() - start;
        walk(crowd, result);
        const double after = crowd.agents.position[0].x() - start;
        if (after < way) continue;
        time = (static_cast<double>(crowd.steps) - (after - way) / (after - before)) * crowd.dt;
        break;
    }
    result.metrics = {
        {"time_outside", std::isnan(time) ? time : std::max({0.0, 26 - time, time - 34}), "s"},
        {"speed_error", std::abs(way / time / desired - 1), "1"},
        {"time", time, "s"},
    };
    return result;
}

// Speed and flow against density in a corridor without ends.

constexpr double rimea_settling = 30;   // s
constexpr double rimea_measuring = 60;  // s

// Numbers of one speed rule over all densities.
struct Diagram {
    std::vector<double> speeds;  // m/s
    double rms = 0;              // of speed minus Weidmann's, m/s
    double largest_flow = 0;     // 1/(m s)
    double density_there = 0;    // 1/m2
    double largest_rise = 0;     // largest rise of the speed from a density to the next, m/s
    Overlaps overlaps;
};

Diagram measure(const Request& request, SpeedRule rule, const std::vector<double>& densities, Result& result) {
    Diagram diagram;
    for (const double density : densities) {
        crowd::CrowdWorld crowd = corridor_crowd(request, rule, density, false);
        Overlaps unused;
        mean_progress(crowd, rimea_settling, result, unused);
        const double speed = mean_progress(crowd, rimea_measuring, result, diagram.overlaps);
        diagram.rms += std::pow(speed - weidmann_speed(density), 2) / static_cast<double>(densities.size());
        if (!diagram.speeds.empty()) {
            diagram.largest_rise = std::max(diagram.largest_rise, speed - diagram.speeds.back());
        }
        diagram.speeds.push_back(speed);
        if (density * speed > diagram.largest_flow) {
            diagram.largest_flow = density * speed;
            diagram.density_there = density;
        }
    }
    diagram.rms = std::sqrt(diagram.rms);
    return diagram;
}

void report(const Diagram& diagram, const std::string& rule, Result& result) {
    result.metrics.push_back({"weidmann_rms_" + rule, diagram.rms, "m/s"});
    result.metrics.push_back({"largest_flow_" + rule, diagram.largest_flow, "1/(m s)"});
    result.metrics.push_back({"density_of_largest_flow_" + rule, diagram.density_there, "1/m2"});
    result.metrics.push_back({"rise_with_density_" + rule, diagram.largest_rise, "m/s"});
    report_overlaps(diagram.overlaps, "_" + rule, result);
}

Result run_rimea_04(const Request& request) {
    // As people a corridor of 160 m2 can hold: whole numbers of them.
    const std::vector<double> densities{0.1, 0.25, 0.5, 0.75, 1, 1.5, 2, 2.5, 3, 4};
    Result result = crowd_result();
    const Diagram pi = measure(request, SpeedRule::pi, densities, result);
    const Diagram per_frame = measure(request, SpeedRule::per_frame, densities, result);
    report(pi, "pi", result);
    report(per_frame, "per_frame", result);
    // Two simulated columns, each beside Weidmann's.
    const std::string abscissa = "density_per_m2";
    Curve speed{
        "speed",
        {abscissa, "speed_pi_m_s", "measured_speed_pi_m_s", "speed_per_frame_m_s", "measured_speed_per_frame_m_s"},
        {}};
    Curve flow{"flow",
               {abscissa, "specific_flow_pi", "measured_specific_flow_pi", "specific_flow_per_frame",
                "measured_specific_flow_per_frame"},
               {}};
    for (std::size_t k = 0; k < densities.size(); ++k) {
        const double rho = densities[k];
        const double weidmann = weidmann_speed(rho);
        speed.rows.push_back({rho, pi.speeds[k], weidmann, per_frame.speeds[k], weidmann});
        flow.rows.push_back({rho, rho * pi.speeds[k], rho * weidmann, rho * per_frame.speeds[k], rho * weidmann});
    }
    result.curves = {speed, flow};
    return result;
}

// RiMEA test 6: people walk round a corner and not through the wall.
bool in_a_wall(const Scene& scene, const crowd::Vector2d& p) {
    for (const Obstacle& o : scene.obstacles) {
        if (o.x.lo < p.x() && p.x() < o.x.hi && o.z.lo < p.y() && p.y() < o.z.hi) return true;
    }
    return false;
}

Result run_rimea_06(const Request& request) {
    const Scene scene = crowd_scene(request, "validation/crowd_rimea_06.json");
    crowd::CrowdWorld crowd = crowd::make_crowd(scene);
    // The end of the first corridor, the beginning of the second and its end.
    const Route route{{{11, 1}, {11, 3}, {1, 0}}, {{11, 3}, {13, 3}, {0, 1}}, {{11, 13}, {13, 13}, {0, 1}}};
    Guide way = make_guide(crowd, {route}, std::vector<std::size_t>(crowd.agents.size(), 0));
    Result result = crowd_result();
    Overlaps overlaps;
    double through_walls = 0;
    std::vector<crowd::Vector2d> before;
    while (!crowd.active.empty() && static_cast<double>(crowd.steps) * crowd.dt < scene.duration) {
        guide(crowd, way);
        before = crowd.agents.position;
        walk(crowd, result);
        for (std::size_t id = 0; id < crowd.agents.size(); ++id) {
            const crowd::Vector2d& p = crowd.agents.position[id];
            const bool inside = in_a_wall(scene, p) || in_a_wall(scene, (p + before[id]) / 2);
            through_walls += inside ? 1 : 0;
        }
        if (crowd.steps % 10 == 0) note_overlaps(crowd, overlaps);
    }
    const std::vector<double> out = passages(way, route.size() - 1);
    result.metrics = {
        {"through_walls", through_walls, "1"},
        {"left_behind", static_cast<double>(crowd.agents.size() - out.size()), "1"},
        {"last_time", out.empty() ? 0 : out.back(), "s"},
    };
    report_overlaps(overlaps, "", result);
    return result;
}

// RiMEA test 9: a crowd leaves a large room by four doors, and by two.
// The doors of crowd_rimea_09.json: 1 m wide in walls 1 m thick, at z = 3 and z = 23. Each is a route through its inner
// and its outer side.
Route door(double x, bool low) {
    const crowd::Vector2d out(0, low ? -1 : 1);
    const double inner = low ? 3 : 23;
    const double outer = low ? 2 : 24;
    return {{{x - 0.5, inner}, {x + 0.5, inner}, out}, {{x - 0.5, outer}, {x + 0.5, outer}, out}};
}

struct Evacuation {
    double left_behind = 0;
    double last = 0;          // s
    double time_of_95 = 0;    // s; NaN if fewer left
    std::vector<double> out;  // times when people left, s
};

Evacuation evacuate(const Scene& scene, const std::vector<Route>& doors, Result& result, Overlaps& overlaps) {
    crowd::CrowdWorld crowd = crowd::make_crowd(scene);
    std::vector<std::size_t> nearest;
    for (const crowd::Vector2d& p : crowd.agents.position) {
        const auto distance = [&](const Route& route) { return ((route[0].a + route[0].b) / 2 - p).squaredNorm(); };
        const auto best = std::min_element(doors.begin(), doors.end(),
                                           [&](const Route& a, const Route& b) { return distance(a) < distance(b); });
        nearest.push_back(static_cast<std::size_t>(best - doors.begin()));
    }
    Guide way = make_guide(crowd, doors, nearest);
    while (!crowd.active.empty() && static_cast<double>(crowd.steps) * crowd.dt < scene.duration) {
        guide(crowd, way);
        walk(crowd, result);
        if (crowd.steps % 300 == 0) note_overlaps(crowd, overlaps);
    }
    Evacuation run;
    run.out = passages(way, 1);
    run.left_behind = static_cast<double>(crowd.agents.size() - run.out.size());
    run.last = run.out.empty() ? 0 : run.out.back();
    const auto wanted = static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(crowd.agents.size())));
    run.time_of_95 = run.out.size() < wanted ? std::numeric_limits<double>::quiet_NaN() : run.out[wanted - 1];
    return run;
}

Result run_rimea_09(const Request& request) {
    Scene scene = crowd_scene(request, "validation/crowd_rimea_09.json");
    Result result = crowd_result();
    Overlaps overlaps;
    const Evacuation four =
        evacuate(scene, {door(10.5, true), door(25.5, true), door(10.5, false), door(25.5, false)}, result, overlaps);
    for (const double x : {10.0, 25.0}) scene.obstacles.push_back({{x, x + 1}, {2, 3}, 3});
    const Evacuation two = evacuate(scene, {door(10.5, false), door(25.5, false)}, result, overlaps);
    result.metrics = {
        {"left_behind_four_doors", four.left_behind, "1"},
        {"left_behind_two_doors", two.left_behind, "1"},
        {"time_of_95_percent_four_doors", four.time_of_95, "s"},
        {"time_of_95_percent_two_doors", two.time_of_95, "s"},
        {"ratio_of_times_of_95_percent", two.time_of_95 / four.time_of_95, "1"},
        {"last_time_four_doors", four.last, "s"},
        {"last_time_two_doors", two.last, "s"},
    };
    report_overlaps(overlaps, "", result);
    Curve left{"people_outside", {"time_s", "four_doors", "two_doors"}, {}};
    const double end = std::max(four.last, two.last);
    for (double t = 0; t <= end + 5; t += 5) {
        const auto by = [&](const std::vector<double>& times) {
            return static_cast<double>(std::upper_bound(times.begin(), times.end(), t) - times.begin());
        };
        left.rows.push_back({t, by(four.out), by(two.out)});
    }
    result.curves = {left};
    return result;
}

// RiMEA test 12: a bottleneck, and its flow against its width.
constexpr double corridor_axis = 6;  // z of the middle of corridor and door, m

// A line of the bottleneck's width at x, passed towards +x.
Gate gate_at(double x, double width) {
    return {{x, corridor_axis - width / 2}, {x, corridor_axis + width / 2}, {1, 0}};
}

// People per m2 in the half disc of 2 m radius before (x, axis).
double density_before(const crowd::CrowdWorld& crowd, double x) {
    double inside = 0;
    for (const std::uint32_t id : crowd.active) {
        const crowd::Vector2d way = crowd.agents.position[id] - crowd::Vector2d(x, corridor_axis);
        inside += way.x() < 0 && way.squaredNorm() < 4 ? 1 : 0;
    }
    return inside / (2 * std::acos(-1.0));
}

struct Passage {
    double left_behind = 0;
    double flow = 0;               // 1/s, of the middle 80 % of passages
    double last = 0;               // s
    double density_corridor = 0;   // 1/m2, largest before the corridor, means of 5 s
    double density_door = 0;       // 1/m2, largest before the door of the second room
    std::vector<double> corridor;  // means of 5 s
    std::vector<double> door;
};

Passage pass(const Scene& scene, const Route& route, Result& result, Overlaps& overlaps) {
    crowd::CrowdWorld crowd = crowd::make_crowd(scene);
    Guide way = make_guide(crowd, {route}, std::vector<std::size_t>(crowd.agents.size(), 0));
    Passage run;
    constexpr std::uint64_t window = 150;  // steps
    double corridor = 0;
    double door = 0;
    while (!crowd.active.empty() && static_cast<double>(crowd.steps) * crowd.dt < scene.duration) {
        guide(crowd, way);
        walk(crowd, result);
        corridor += density_before(crowd, 11) / window;
        door += density_before(crowd, 26) / window;
        if (crowd.steps % 30 == 0) note_overlaps(crowd, overlaps);
        if (crowd.steps % window != 0) continue;
        run.corridor.push_back(corridor);
        run.door.push_back(door);
        run.density_corridor = std::max(run.density_corridor, corridor);
        run.density_door = std::max(run.density_door, door);
        corridor = door = 0;
    }
    const std::vector<double> through = passages(way, 1);  // the end of the corridor
    run.left_behind = static_cast<double>(crowd.agents.size() - passages(way, route.size() - 1).size());
    run.last = through.empty() ? 0 : through.back();
    const std::size_t tenth = through.size() / 10;
    if (through.size() < 20) {
        run.flow = std::numeric_limits<double>::quiet_NaN();
    } else {
        const std::size_t last = through.size() - 1 - tenth;
        run.flow = static_cast<double>(last - tenth) / (through[last] - through[tenth]);
    }
    return run;
}

// The corridor of another width and no door behind it.
Scene bottleneck(Scene scene, double width) {
    scene.obstacles.at(0).z.hi = corridor_axis - width / 2;
    scene.obstacles.at(1).z.lo = corridor_axis + width / 2;
    scene.obstacles.erase(scene.obstacles.begin() + 2, scene.obstacles.begin() + 4);
    return scene;
}

Result run_rimea_12(const Request& request) {
    const Scene scene = crowd_scene(request, "validation/crowd_rimea_12.json");
    Result result = crowd_result();
    Overlaps overlaps;
    const Passage rooms =
        pass(scene, {gate_at(11, 1), gate_at(16, 1), gate_at(26, 1), gate_at(27, 1)}, result, overlaps);

    Curve flow{
        "flow", {"width_m", "people_per_second", "measured_people_per_second", "reference_people_per_second"}, {}};
    const double none = std::numeric_limits<double>::quiet_NaN();  // Seyfried measured 0.8 to 1.2 m
    double worst_left = 0;
    double most = 0;
    double least = std::numeric_limits<double>::infinity();
    double slope = 0;
    double squares = 0;
    std::vector<Metric> flows;
    for (const double width : {0.8, 1.0, 1.2, 1.6, 2.0, 2.4}) {
        const Passage one =
            pass(bottleneck(scene, width), {gate_at(11, width), gate_at(16, width), gate_at(20, 10)}, result, overlaps);
        const double specific = one.flow / width;
        worst_left = std::max(worst_left, one.left_behind);
        most = std::max(most, specific);
        least = std::min(least, specific);
        slope += one.flow * width;
        squares += width * width;
        flow.rows.push_back({width, one.flow, width <= 1.2 ? 1.9 * width : none, 1.3 * width});
        flows.push_back({"specific_flow_" + std::to_string(std::lround(100 * width)) + "_cm", specific, "1/(m s)"});
    }
    result.metrics = {
        {"left_behind_rooms", rooms.left_behind, "1"},
        {"density_before_corridor", rooms.density_corridor, "1/m2"},
        {"density_before_door", rooms.density_door, "1/m2"},
        {"last_time_rooms", rooms.last, "s"},
        {"left_behind_bottlenecks", worst_left, "1"},
        {"specific_flow_fitted", slope / squares, "1/(m s)"},
        {"specific_flow_least", least, "1/(m s)"},
        {"specific_flow_most", most, "1/(m s)"},
    };
    result.metrics.insert(result.metrics.end(), flows.begin(), flows.end());
    report_overlaps(overlaps, "", result);
    Curve density{"density", {"time_s", "density_before_corridor_per_m2", "density_before_door_per_m2"}, {}};
    for (std::size_t k = 0; k < rooms.corridor.size(); ++k) {
        density.rows.push_back({5.0 * static_cast<double>(k + 1), rooms.corridor[k], rooms.door[k]});
    }
    result.curves = {flow, density};
    return result;
}

}  // namespace

Case crowd_rimea_01_case() {
    return {.name = "crowd_rimea_01",
            .truth =
                "RiMEA guideline 3.0, test 1: a person that walks at 1.33 m/s needs 26 to 34 s for the 40 m of a "
                "corridor 2 m wide. Levels: 16, 32 and 64 markers per m2.",
            .reference = "RiMEA test 1",
            .spacings = marker_spacings,
            .quick = true,
            .run = run_rimea_01};
}

Case crowd_rimea_04_case() {
    return {.name = "crowd_rimea_04",
            .truth =
                "RiMEA guideline 3.0, test 4: speed and flow against density, here in a corridor 8 m wide that repeats "
                "after 20 m, beside Weidmann 1993: v = 1.34 (1 - exp(-1.913 (1/rho - 1/5.4))) m/s. Means of 60 s "
                "after 30 s, flow in 1/(m s). Levels: 16, 32 and 64 markers per m2.",
            .reference = "Weidmann 1993",
            .spacings = marker_spacings,
            .run = run_rimea_04};
}

Case crowd_rimea_06_case() {
    return {.name = "crowd_rimea_06",
            .truth =
                "RiMEA guideline 3.0, test 6: 20 people walk round a corner to the left without passing through "
                "walls. The way is given by gates, as the model knows none. Levels: 16, 32 and 64 markers per m2.",
            .reference = "RiMEA test 6",
            .spacings = marker_spacings,
            .quick = true,
            .run = run_rimea_06};
}

Case crowd_rimea_09_case() {
    return {.name = "crowd_rimea_09",
            .truth =
                "RiMEA guideline, test 9: 1000 people leave a room of 30 x 20 m by four doors of 1 m, then with "
                "two of them closed; the time should about double. The guideline says that this documents a model "
                "and is no criterion to reject one. Everybody goes to the nearest open door. Levels: 16, 32 and 64 "
                "markers per m2.",
            .reference = "RiMEA test 9",
            .spacings = marker_spacings,
            .run = run_rimea_09};
}

Case crowd_rimea_12_case() {
    return {
        .name = "crowd_rimea_12",
        .truth =
            "RiMEA guideline, test 12: 150 people go from a room through a corridor of 1 x 5 m into another and out "
            "by a door; a jam may form in the first room only (the guideline calls this documentation, no criterion "
            "to reject). Then the flow of the corridor alone, 0.8 to 2.4 m wide, beside 1.9 b per second (Seyfried "
            "et al. 2009, Transportation Science 43(3), experiments with b 0.8 to 1.2 m) and the 1.3 b of the SFPE "
            "handbook. Levels: 16, 32 and 64 markers per m2.",
        .reference = "1.3 to 1.9 1/(m s)",
        .spacings = marker_spacings,
        .run = run_rimea_12};
}

}  // namespace wade::validation
