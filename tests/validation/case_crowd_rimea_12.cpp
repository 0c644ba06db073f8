// RiMEA test 12: a bottleneck, and its flow against its width.

#include <algorithm>
#include <cmath>
#include <limits>

#include "cases.hpp"
#include "crowd_route.hpp"
#include "crowd_run.hpp"

namespace wade::validation {

namespace {

constexpr double axis = 6;  // z of the middle of corridor and door, m

// A line of the bottleneck's width at x, passed towards +x.
Gate gate_at(double x, double width) {
    return {{x, axis - width / 2}, {x, axis + width / 2}, {1, 0}};
}

// People per m2 in the half disc of 2 m radius before (x, axis).
double density_before(const crowd::CrowdWorld& crowd, double x) {
    double inside = 0;
    for (const std::uint32_t id : crowd.active) {
        const crowd::Vector2d way = crowd.agents.position[id] - crowd::Vector2d(x, axis);
        inside += way.x() < 0 && way.squaredNorm() < 4 ? 1 : 0;
    }
    return inside / (2 * std::acos(-1.0));
}

struct Passage {
    double left_behind = 0;
    double flow = 0;               // 1/s, of the middle 80 % of those who passed
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
    scene.obstacles.at(0).z.hi = axis - width / 2;
    scene.obstacles.at(1).z.lo = axis + width / 2;
    scene.obstacles.erase(scene.obstacles.begin() + 2, scene.obstacles.begin() + 4);
    return scene;
}

Result run(const Request& request) {
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
        .run = run};
}

}  // namespace wade::validation
