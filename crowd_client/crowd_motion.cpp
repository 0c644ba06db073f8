#include "crowd_client/crowd_motion.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/world.hpp"

namespace wade::crowd {
namespace {

// Returns true if agents keep a velocity from step to step.
bool keep_velocity(const CrowdWorld& crowd) {
    return !crowd.next.at_end.empty();
}

// Returns the velocity after walls stopped the motion from `from` by `wanted` at `to`: 0 along each axis that they cut.
Vector2d stopped_at_walls(const Vector2d& velocity, const Vector2d& from, const Vector2d& wanted, const Vector2d& to) {
    const Vector2d free = from + wanted;
    return {to.x() == free.x() ? velocity.x() : 0, to.y() == free.y() ? velocity.y() : 0};
}

// Returns the range of x for agent k. No agent walks over the outfall at x = 0; water that flows towards it may carry
// one over.
Interval ends_of_step(const CrowdWorld& crowd, std::size_t k) {
    const std::uint32_t id = crowd.active[k];
    const bool carried_down = crowd.agents.people.by_body[id] != 0
                                  ? crowd.felt[k].velocity.x() < 0
                                  : crowd.agents.tau[id] > 0 && crowd.contacts[k].momentum.x() < 0;
    return ends_for(crowd.walls, crowd.positions[k], crowd.agents.goal[id].x(), carried_down);
}

// Wraps the position of an agent at a periodic boundary.
void wrap(Vector2d& p, std::int32_t& laps, double period) {
    const double lap = std::floor(p.x() / period);
    p.x() -= lap * period;
    laps += static_cast<std::int32_t>(lap);
    if (p.x() < period) return;
    p.x() = 0;  // rounding: p.x() was below 0 by less than the precision of the period
    ++laps;
}

// Removes the velocity component, along the lost displacement, that contact with bodies stopped.
Vector2d stopped_by_bodies(const Vector2d& velocity, const Vector2d& wanted, const Vector2d& way, double dt) {
    const Vector2d lost = wanted - way;
    const Vector2d n = unit_or(lost, Vector2d::Zero());
    return velocity - std::max(0.0, velocity.dot(n) - way.dot(n) / dt) * n;
}

void limit_to_bodies(CrowdWorld& crowd) {
    const std::size_t n = crowd.active.size();
    crowd.wishes.resize(n);
    crowd.ends.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
        crowd.wishes[k] = crowd.next.mean[k] * crowd.part_time;
        crowd.ends[k] = ends_of_step(crowd, k);
    }
    limit_steps(crowd.bodies, crowd.agents, crowd.active, crowd.walls, crowd.positions, crowd.wishes, crowd.ends,
                crowd.part_time, threads_for(crowd));
}

// Returns the new position of agent k with its body, and updates its velocity.
Vector2d step_with_body(CrowdWorld& crowd, std::size_t k) {
    const std::uint32_t id = crowd.active[k];
    const Vector2d& u = crowd.bodies.step[k];
    if (keep_velocity(crowd)) {
        crowd.agents.momentary[id] = stopped_by_bodies(crowd.next.at_end[k], crowd.wishes[k], u, crowd.part_time);
    }
    Vector2d to = crowd.positions[k] + u;
    to.x() = std::clamp(to.x(), crowd.ends[k].lo, crowd.ends[k].hi);
    to.y() = std::clamp(to.y(), 0.0, crowd.scene.world->width);
    return to;
}

bool goes_with_water(const CrowdWorld& crowd, std::size_t k) {
    const std::uint32_t id = crowd.active[k];
    if (crowd.agents.people.by_body[id] != 0) {
        const PersonState state = crowd.agents.people.condition[id].state;
        return !has_ground(state) && state != PersonState::holding;
    }
    const Vector2d& push = crowd.contacts[k].momentum;
    return crowd.agents.velocity[id].dot(push) > std::max(0.0, crowd.walking[k].dot(push));
}

}  // namespace

bool leaves_with_water(const CrowdWorld& crowd, std::size_t k) {
    if (!crowd.scene.site || !goes_with_water(crowd, k)) return false;
    const Vector2d& at = crowd.agents.position[crowd.active[k]];
    const Fluid& f = crowd.scene.fluid;
    const double reach = 1.5 * (f.model == ModelKind::shallow_water ? f.shallow_water.cell_size : f.particle_spacing);
    return std::ranges::any_of(crowd.scene.site->outlets, [&](const Outlet& outlet) {
        return is_at(outlet, {at.x(), at.y()}, reach);
    });
}

void move_agents(CrowdWorld& crowd) {
    Agents& agents = crowd.agents;
    if (has_bodies(crowd)) limit_to_bodies(crowd);
    const double period = crowd.scene.world->period();
    for (std::size_t k = 0; k < crowd.active.size(); ++k) {
        const std::uint32_t id = crowd.active[k];
        const Vector2d& from = crowd.positions[k];
        const Vector2d wanted = crowd.next.mean[k] * crowd.part_time;
        const Vector2d to =
            has_bodies(crowd) ? step_with_body(crowd, k) : slide(crowd.walls, from, wanted, ends_of_step(crowd, k));
        if (keep_velocity(crowd) && !has_bodies(crowd)) {
            agents.momentary[id] = stopped_at_walls(crowd.next.at_end[k], from, wanted, to);
        }
        const Vector2d way = to - from;
        const double length = std::sqrt(way.squaredNorm());
        agents.position[id] = to;
        agents.velocity[id] = way / crowd.part_time;
        agents.path_length[id] += length;
        agents.heading[id] = unit_or(way, agents.heading[id]);
        if (period > 0) wrap(agents.position[id], agents.laps[id], period);
        if (agents.people.by_body[id] != 0) {
            const Vector2d counted_on = agents.position[id] + Vector2d(agents.laps[id] * period, 0);
            note_stop(agents.people, id, counted_on, way, wanted, crowd.part_time);
        }
    }
}

}  // namespace wade::crowd
