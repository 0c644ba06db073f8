#include "crowd_corridor.hpp"

#include <cmath>

namespace wade::validation {

double weidmann_speed(double density) {
    return 1.34 * (1 - std::exp(-1.913 * (1 / density - 1 / 5.4)));
}

crowd::CrowdWorld corridor_crowd(const Request& request, SpeedRule rule, double density, bool two_ways,
                                 const Interval& across) {
    Scene scene = crowd_scene(request, "validation/crowd_ring_corridor.json");
    scene.crowd.speed_rule = rule;
    const double length = scene.world.length;
    scene.obstacles.at(0).z.hi = across.lo;
    scene.obstacles.at(1).z.lo = across.hi;
    const double width = across.length();
    const int people = static_cast<int>(std::lround(density * length * width));
    AgentGroup& group = scene.crowd.groups.at(0);
    group.rows = std::max(1, static_cast<int>(std::lround(std::sqrt(people * width / length))));
    group.columns = (people + group.rows - 1) / group.rows;
    group.count = people;
    group.pitch_x = length / group.columns;
    group.pitch_z = width / group.rows;
    group.start_x = group.pitch_x / 2;
    group.start_z = across.lo + group.pitch_z / 2;
    crowd::CrowdWorld crowd = crowd::make_crowd(scene);
    jitter(crowd, 0.3 * group.pitch_x, 0.3 * group.pitch_z);
    if (scene.crowd.bodies != BodyRule::none) {
        crowd::make_room_for_bodies(crowd.agents, crowd.walls, scene.crowd.body_radius);
    }
    for (std::size_t id = 1; two_ways && id < crowd.agents.size(); id += 2) crowd.agents.goal[id].x() *= -1;
    return crowd;
}

double mean_progress(crowd::CrowdWorld& crowd, double time, Result& result, Overlaps& overlaps,
                     const std::function<void()>& after_step) {
    const auto place = [&](std::size_t id) {
        return crowd.agents.goal[id].x() > 0 ? unrolled_x(crowd, id) : -unrolled_x(crowd, id);
    };
    double start = 0;
    for (std::size_t id = 0; id < crowd.agents.size(); ++id) start += place(id);
    const auto steps = static_cast<int>(std::lround(time / crowd.dt));
    for (int k = 1; k <= steps; ++k) {
        walk(crowd, result);
        if (after_step) after_step();
        if (k % 10 == 0) note_overlaps(crowd, overlaps);
    }
    double end = 0;
    for (std::size_t id = 0; id < crowd.agents.size(); ++id) end += place(id);
    return (end - start) / static_cast<double>(crowd.agents.size()) / (steps * crowd.dt);
}

}  // namespace wade::validation
