#include "crowd_route.hpp"

#include <algorithm>
#include <cmath>

namespace wade::validation {

namespace {

// A bit behind the nearest point of the gate, so that the direction is defined at the gate itself; then far beyond, so
// that nobody arrives there.
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

}  // namespace wade::validation
