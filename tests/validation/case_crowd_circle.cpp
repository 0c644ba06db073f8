// Fifty people on a circle, each wants to the opposite side.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cases.hpp"
#include "crowd_run.hpp"

namespace wade::validation {

namespace {

// Sets of markers, each a run of its own: whether a crowd jams is a matter of chance.
constexpr std::uint64_t seeds = 5;

Scene circle_scene(const Request& request, SpeedRule rule) {
    Scene scene = crowd_scene(request, "validation/crowd_circle.json");
    scene.crowd.speed_rule = rule;
    constexpr int people = 50;
    constexpr double radius = 10;  // m
    const double centre = scene.world.length / 2;
    for (int k = 0; k < people; ++k) {
        const double angle = 2 * std::numbers::pi * k / people;
        AgentGroup group;
        group.name = "person_" + std::to_string(k);
        group.start_x = centre + radius * std::cos(angle);
        group.start_z = centre + radius * std::sin(angle);
        group.goal_x = 2 * centre - group.start_x;
        group.goal_z = 2 * centre - group.start_z;
        group.desired_speed = 1.34;
        scene.crowd.groups.push_back(group);
    }
    return scene;
}

void measure(const Request& request, SpeedRule rule, const std::string& suffix, Result& result) {
    Scene scene = circle_scene(request, rule);
    const double ideal = (20 - scene.crowd.goal_radius) / scene.crowd.groups.at(0).desired_speed;
    const auto people = static_cast<double>(scene.crowd.groups.size());
    Overlaps overlaps;
    double worst = 0;
    double arrived = 0;
    double time = 0;  // of all who arrived, s
    double last = 0;  // s
    const std::uint64_t first_seed = scene.seed;
    for (std::uint64_t run = 0; run < seeds; ++run) {
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
    result.metrics.push_back({"arrived_share" + suffix, arrived / people / static_cast<double>(seeds), "1"});
    result.metrics.push_back({"mean_time" + suffix, time / arrived / ideal, "1"});
    result.metrics.push_back({"last_time" + suffix, last / ideal, "1"});
    report_overlaps(overlaps, suffix, result);
}

Result run(const Request& request) {
    Result result = crowd_result();
    measure(request, SpeedRule::pi, "_pi", result);
    measure(request, SpeedRule::per_frame, "_per_frame", result);
    return result;
}

}  // namespace

Case crowd_circle_case() {
    return {.name = "crowd_circle",
            .truth =
                "Fifty people on a circle of 10 m radius walk to the opposite side; all must get there within "
                "300 s, with each of five sets of markers (left_behind: the worst). Times over that of one who meets "
                "nobody, 14.6 s. Levels: 16, 32 and 64 markers per m2.",
            .reference = "all arrive",
            .spacings = marker_spacings,
            .run = run};
}

}  // namespace wade::validation
