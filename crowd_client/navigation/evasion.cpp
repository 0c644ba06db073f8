#include "crowd_client/navigation/evasion.hpp"

#include <cmath>

#include "configs/scene/crowd.hpp"
#include "configs/scene/steering_behaviours.hpp"

namespace wade::crowd {

namespace {

// Length of the offset that stands for a goal; Eq. 3 uses its direction alone.
constexpr double far_away = 10;

// The water that an agent perceives.
struct SeenWater {
    double count = 0;
    Vector2d place = Vector2d::Zero(), velocity = Vector2d::Zero(), direction = Vector2d::Zero();  // sums
};

SeenWater look(const WaterBins& water, const Vector2d& agent, double radius) {
    SeenWater seen;
    const int column = GroundGrid::line_of(agent.x()), row = GroundGrid::line_of(agent.y());
    for (int r = row - 1; r <= row + 1; ++r) {
        const std::size_t first = water.grid.index(column - 1, r);
        for (std::uint32_t k = water.cell_start[first]; k < water.cell_start[first + 3]; ++k) {
            const Vector2d way = Vector2d(water.x[k], water.z[k]) - agent;
            const double distance = std::sqrt(way.squaredNorm());
            if (!(distance < radius)) continue;
            seen.count += 1;
            seen.place += way;
            seen.velocity += water.particle(k).velocity;
            if (distance > 0) seen.direction += way / distance;
        }
    }
    return seen;
}

behaviours::Vector in_space(const Vector2d& v) {
    return {v.x(), 0, v.y()};
}

}  // namespace

void evade(const EvasionSettings& settings, const Agents& agents, std::span<const std::uint32_t> active,
           std::span<const Vector2d> positions, const WaterBins& water, std::span<Vector2d> goal_offsets) {
    for (std::size_t k = 0; k < active.size(); ++k) {
        const SeenWater seen = look(water, positions[k], settings.radius);
        if (seen.count == 0 || std::sqrt(seen.direction.squaredNorm()) < surrounded * seen.count) continue;
        behaviours::Vehicle agent;
        agent.max_speed = agents.desired_speed[active[k]];
        if (!(agent.max_speed > 0)) continue;
        const behaviours::Vector place = in_space(seen.place / seen.count);  // from the agent
        const behaviours::Vector velocity = in_space(seen.velocity / seen.count);
        const behaviours::Vector steering = settings.rule == EvasionRule::flee
                                                ? behaviours::flee(agent, place)
                                                : behaviours::evasion(agent, place, velocity, settings.prediction);
        // The agent's own velocity is zero here, so that the steering is the desired velocity.
        const Vector2d wish(steering[0], steering[2]);
        if (wish.squaredNorm() > 0) goal_offsets[k] = far_away * wish / std::sqrt(wish.squaredNorm());
    }
}

}  // namespace wade::crowd
