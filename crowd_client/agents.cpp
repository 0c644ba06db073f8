#include "crowd_client/agents.hpp"

#include <cmath>
#include <sstream>

#include "configs/exit_code.hpp"

namespace wade::crowd {
namespace {

Vector2d unit_or_zero(const Vector2d& v) {
    const double length = std::sqrt(v.squaredNorm());
    return length > 0 ? Vector2d(v / length) : Vector2d::Zero();
}

void check_start(const World& world, std::size_t group, int member, const Vector2d& p) {
    if (p.x() >= 0 && p.x() <= world.length && p.y() >= 0 && p.y() <= world.width) return;
    std::ostringstream message;
    message << "/crowd/groups/" << group << ": agent " << member << " of the group starts at (" << p.x() << ", "
            << p.y() << "), outside the world [0, " << world.length << "] x [0, " << world.width << "] m";
    throw ConfigurationError(message.str());
}

}  // namespace

std::string_view outcome_name(Outcome outcome) {
    switch (outcome) {
        case Outcome::arrived:
            return "arrived";
        case Outcome::dead:
            return "dead";
        case Outcome::active:
            break;
    }
    return "active";
}

Agents make_agents(const Scene& scene) {
    Agents agents;
    for (std::size_t g = 0; g < scene.crowd.groups.size(); ++g) {
        const AgentGroup& group = scene.crowd.groups[g];
        for (int k = 0; k < group.count; ++k) {
            const int column = k % group.columns;
            const int row = k / group.columns;
            const Vector2d start(group.start_x + column * group.pitch_x, group.start_z + row * group.pitch_z);
            check_start(scene.world, g, k, start);
            const Vector2d goal(group.goal_x, group.goal_z);
            agents.position.push_back(start);
            agents.heading.push_back(unit_or_zero(goal - start));
            agents.goal.push_back(goal);
            agents.desired_speed.push_back(group.desired_speed);
            agents.mass.push_back(group.mass);
            agents.tau.push_back(group.tau);
            agents.group.push_back(static_cast<std::uint32_t>(g));
        }
    }
    const std::size_t n = agents.position.size();
    agents.laps.assign(n, 0);
    agents.velocity.assign(n, Vector2d::Zero());
    agents.outcome.assign(n, Outcome::active);
    agents.end_step.assign(n, 0);
    agents.path_length.assign(n, 0.0);
    agents.max_depth.assign(n, 0.0);
    agents.max_dv.assign(n, 0.0);
    return agents;
}

}  // namespace wade::crowd
