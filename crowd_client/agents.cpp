#include "crowd_client/agents.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "configs/exit_code.hpp"
#include "crowd_client/counter_random.hpp"

namespace wade::crowd {
namespace {

Vector2d unit_or_zero(const Vector2d& v) {
    const double length = std::sqrt(v.squaredNorm());
    return length > 0 ? Vector2d(v / length) : Vector2d::Zero();
}

// Random numbers of the agents, apart from those of the markers: a stream for each agent, a counter for each purpose.
// The starts take the counters from `start` on, two a trial.
enum Draw : std::uint64_t { draw_tau, draw_mass, draw_start = 16 };

double random_of(const Scene& scene, std::size_t id, std::uint64_t draw) {
    constexpr std::uint64_t agents_streams = std::uint64_t{1} << 40;
    return counter_uniform(scene.seed, agents_streams + id, draw);
}

// A deviation past the edge is mirrored, so that starts near the edge stay spread.
double mirrored_into(double v, double length) {
    if (v < 0) v = -v;
    if (v > length) v = 2 * length - v;
    return std::clamp(v, 0.0, length);
}

bool in_an_obstacle(const Scene& scene, const Vector2d& p) {
    return std::any_of(scene.obstacles.begin(), scene.obstacles.end(),
                       [&](const Obstacle& o) { return o.x.contains(p.x()) && o.z.contains(p.y()); });
}

// The start of an agent whose place on the grid is `place`, which is free.
Vector2d jittered(const Scene& scene, std::size_t id, const Vector2d& place, double jitter) {
    if (!(jitter > 0)) return place;
    const double period = scene.world.period();
    constexpr std::uint64_t trials = 100;
    for (std::uint64_t trial = 0; trial < trials; ++trial) {
        const double u = random_of(scene, id, draw_start + 2 * trial);
        const double w = random_of(scene, id, draw_start + 2 * trial + 1);
        Vector2d start = place + jitter * Vector2d(2 * u - 1, 2 * w - 1);
        start.x() = period > 0 ? start.x() - period * std::floor(start.x() / period)
                               : mirrored_into(start.x(), scene.world.length);
        if (period > 0 && start.x() >= period) start.x() = 0;
        start.y() = mirrored_into(start.y(), scene.world.width);
        if (!in_an_obstacle(scene, start)) return start;
    }
    return place;
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
            const Vector2d place(group.start_x + column * group.pitch_x, group.start_z + row * group.pitch_z);
            check_start(scene.world, g, k, place);
            const std::size_t id = agents.position.size();
            const Vector2d start = jittered(scene, id, place, group.start_jitter);
            const Vector2d goal(group.goal_x, group.goal_z);
            agents.position.push_back(start);
            agents.heading.push_back(unit_or_zero(goal - start));
            agents.goal.push_back(goal);
            agents.desired_speed.push_back(group.desired_speed);
            agents.mass.push_back(group.mass.at(random_of(scene, id, draw_mass)));
            agents.tau.push_back(group.tau.at(random_of(scene, id, draw_tau)));
            agents.group.push_back(static_cast<std::uint32_t>(g));
        }
    }
    const std::size_t n = agents.position.size();
    agents.laps.assign(n, 0);
    agents.velocity.assign(n, Vector2d::Zero());
    agents.momentary.assign(n, Vector2d::Zero());
    agents.outcome.assign(n, Outcome::active);
    agents.end_step.assign(n, 0);
    agents.path_length.assign(n, 0.0);
    agents.max_depth.assign(n, 0.0);
    agents.max_dv.assign(n, 0.0);
    return agents;
}

}  // namespace wade::crowd
