// RiMEA test 9: a crowd leaves a large room by four doors, and by two.

#include <algorithm>
#include <cmath>
#include <limits>

#include "cases.hpp"
#include "crowd_route.hpp"
#include "crowd_run.hpp"

namespace wade::validation {

namespace {

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
    std::vector<double> out;  // times at which people left, s
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

Result run(const Request& request) {
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

}  // namespace

Case crowd_rimea_09_case() {
    return {.name = "crowd_rimea_09",
            .truth =
                "RiMEA guideline, test 9: 1000 people leave a room of 30 x 20 m by four doors of 1 m, then with "
                "two of them closed; the time should about double. The guideline says that this documents a model "
                "and is no criterion to reject one. Everybody goes to the nearest open door. Levels: 16, 32 and 64 "
                "markers per m2.",
            .reference = "RiMEA test 9",
            .spacings = marker_spacings,
            .run = run};
}

}  // namespace wade::validation
