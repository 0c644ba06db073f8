#include "crowd_route.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene/crowd.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/world.hpp"

namespace wade::validation {

namespace {

// Returns a goal in the direction of a point a bit behind the gate, so that the direction is defined at the gate
// itself. The goal is far beyond, so that no agent arrives there.
crowd::Vector2d goal_behind(const Gate& gate, const crowd::Vector2d& p) {
    constexpr double behind = 0.2;   // m
    constexpr double beyond = 1000;  // m
    const crowd::Vector2d along = gate.b - gate.a;
    const double length = along.norm();
    const double inset = std::min(gate.inset, length / 2);
    const double s = std::clamp(along.dot(p - gate.a) / length, inset, length - inset);
    const crowd::Vector2d target = gate.a + along * (s / length) + behind * gate.forward;
    return p + beyond * (target - p).normalized();
}

}  // namespace

Guide make_guide(const crowd::CrowdWorld& crowd, std::vector<Route> routes, std::vector<std::size_t> route_of) {
    Guide made;
    made.routes = std::move(routes);
    made.route_of = std::move(route_of);
    made.next_gate.assign(crowd.agents.size(), 0);
    made.passed_at.resize(crowd.agents.size());
    return made;
}

void guide(crowd::CrowdWorld& crowd, Guide& guide) {
    const double now = static_cast<double>(crowd.steps) * crowd.dt;
    for (const std::uint32_t id : crowd.active) {
        const Route& route = guide.routes[guide.route_of[id]];
        const crowd::Vector2d& p = crowd.agents.position[id];
        std::size_t& next = guide.next_gate[id];
        while (next < route.size() && route[next].forward.dot(p - route[next].a) >= 0) {
            guide.passed_at[id].push_back(now);
            ++next;
        }
        crowd.agents.goal[id] = next < route.size() ? goal_behind(route[next], p) : p;
    }
}

std::vector<double> passages(const Guide& guide, std::size_t gate) {
    std::vector<double> times;
    for (const std::vector<double>& passed : guide.passed_at) {
        if (gate < passed.size()) times.push_back(passed[gate]);
    }
    std::sort(times.begin(), times.end());
    return times;
}

double weidmann_speed(double density) {
    return 1.34 * (1 - std::exp(-1.913 * (1 / density - 1 / 5.4)));
}

crowd::CrowdWorld corridor_crowd(const Request& request, SpeedRule rule, double density, bool two_ways,
                                 const Interval& across) {
    Scene scene = crowd_scene(request, "validation/crowd_ring_corridor.json");
    scene.crowd->speed_rule = rule;
    const double length = scene.world->length;
    scene.obstacles.at(0).z.hi = across.lo;
    scene.obstacles.at(1).z.lo = across.hi;
    const double width = across.length();
    const int people = static_cast<int>(std::lround(density * length * width));
    AgentGroup& group = scene.crowd->groups.at(0);
    group.rows = std::max(1, static_cast<int>(std::lround(std::sqrt(people * width / length))));
    group.columns = (people + group.rows - 1) / group.rows;
    group.count = people;
    group.pitch_x = length / group.columns;
    group.pitch_z = width / group.rows;
    group.start_x = group.pitch_x / 2;
    group.start_z = across.lo + group.pitch_z / 2;
    crowd::CrowdWorld crowd = crowd::make_crowd(scene);
    jitter(crowd, 0.3 * group.pitch_x, 0.3 * group.pitch_z);
    if (scene.crowd->bodies != BodyRule::none) {
        crowd::make_room_for_bodies(crowd.agents, crowd.walls, scene.crowd->body_radius);
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
