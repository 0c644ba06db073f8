// RiMEA test 1: a person in a corridor keeps the speed that it is given.

#include <algorithm>
#include <cmath>
#include <limits>

#include "cases.hpp"
#include "crowd_run.hpp"

namespace wade::validation {

namespace {

Result run(const Request& request) {
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

}  // namespace

Case crowd_rimea_01_case() {
    return {.name = "crowd_rimea_01",
            .truth =
                "RiMEA guideline 3.0, test 1: a person that walks at 1.33 m/s needs 26 to 34 s for the 40 m of a "
                "corridor 2 m wide. Levels: 16, 32 and 64 markers per m2.",
            .reference = "RiMEA test 1",
            .spacings = marker_spacings,
            .quick = true,
            .run = run};
}

}  // namespace wade::validation
