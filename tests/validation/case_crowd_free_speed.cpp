// People who meet nobody walk at their desired speed.

#include <cmath>

#include "cases.hpp"
#include "crowd_run.hpp"

namespace wade::validation {

namespace {

// |m| of Eq. 1 in the middle of a full disc of 1 m radius for evenly spread markers, m; see tests/unit of the crowd.
const double free_motion = (std::log(2.0) - 0.5) / (2 * (1 - std::log(2.0)));

// Mean progress along x over `time` seconds, m/s.
double mean_speed(Scene scene, SpeedRule rule, double time, Result& result) {
    scene.crowd.speed_rule = rule;
    crowd::CrowdWorld crowd = crowd::make_crowd(scene);
    double start = 0;
    for (std::size_t id = 0; id < crowd.agents.size(); ++id) start += unrolled_x(crowd, id);
    while (static_cast<double>(crowd.steps) * crowd.dt < time - crowd.dt / 2) walk(crowd, result);
    double end = 0;
    for (std::size_t id = 0; id < crowd.agents.size(); ++id) end += unrolled_x(crowd, id);
    return (end - start) / static_cast<double>(crowd.agents.size()) / time;
}

Result run(const Request& request) {
    const Scene scene = crowd_scene(request, "validation/crowd_free.json");
    const double desired = scene.crowd.groups.at(0).desired_speed;
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
            .run = run};
}

}  // namespace wade::validation
