// RiMEA test 6: people walk round a corner and not through the wall.

#include "cases.hpp"
#include "crowd_route.hpp"
#include "crowd_run.hpp"

namespace wade::validation {

namespace {

bool in_a_wall(const Scene& scene, const crowd::Vector2d& p) {
    for (const Obstacle& o : scene.obstacles) {
        if (o.x.lo < p.x() && p.x() < o.x.hi && o.z.lo < p.y() && p.y() < o.z.hi) return true;
    }
    return false;
}

Result run(const Request& request) {
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

}  // namespace

Case crowd_rimea_06_case() {
    return {.name = "crowd_rimea_06",
            .truth =
                "RiMEA guideline 3.0, test 6: 20 people walk round a corner to the left without passing through "
                "walls. The way is given by gates, as the model knows none. Levels: 16, 32 and 64 markers per m2.",
            .reference = "RiMEA test 6",
            .spacings = marker_spacings,
            .quick = true,
            .run = run};
}

}  // namespace wade::validation
