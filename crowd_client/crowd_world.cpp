#include "crowd_client/crowd_world.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "configs/exit_code.hpp"
#include "configs/scene_frames.hpp"
#include "crowd_client/contacts.hpp"
#include "crowd_client/sampled_coupling.hpp"
#include "crowd_client/water_met.hpp"

namespace wade::crowd {
namespace {

void check_coupling(const Scene& scene) {
    const double distance = contact_distance(scene.coupling);
    std::ostringstream message;
    if (!(distance > 0)) {
        message << "/coupling: agent_radius_m and particle_radius_m are both " << scene.coupling.agent_radius
                << ", so that with contact_rule 'difference' no water ever touches an agent";
    } else if (distance > GroundGrid::cell_size) {
        message << "/coupling: contact distance " << distance << " m, allowed is up to " << GroundGrid::cell_size
                << " m (the size of a cell)";
    } else if (!(scene.frame_rate > 0)) {
        message << "/frame_rate_hz is " << scene.frame_rate << ", allowed is more than 0";
    } else if (!(scene.crowd.step_rate > 0)) {
        message << "/crowd/step_rate_hz is " << scene.crowd.step_rate << ", allowed is more than 0";
    } else {
        return;
    }
    throw ConfigurationError(message.str());
}

void move_out_of_faces(Agents& agents, const Walls& walls) {
    for (std::size_t id = 0; id < agents.size(); ++id) {
        const std::optional<Vector2d> place = place_outside(walls, agents.position[id]);
        if (!place) {
            std::ostringstream message;
            message << "/crowd/groups/" << agents.group[id] << ": agent " << id << " starts at ("
                    << agents.position[id].x() << ", " << agents.position[id].y() << "), inside an obstacle";
            throw ConfigurationError(message.str());
        }
        agents.position[id] = *place;
    }
}

void apply_event(Agents& agents, const Scene& scene, const TauEvent& event) {
    for (std::size_t id = 0; id < agents.size(); ++id) {
        const bool by_id = !event.agent || static_cast<std::size_t>(*event.agent) == id;
        const bool by_group = !event.group || scene.crowd.groups[agents.group[id]].name == *event.group;
        if (by_id && by_group) agents.tau[id] = event.tau;
    }
}

void apply_events_due(CrowdWorld& crowd, std::uint64_t step) {
    const std::vector<TauEvent>& events = crowd.scene.events;
    for (; crowd.events_applied < events.size(); ++crowd.events_applied) {
        const TauEvent& event = events[crowd.events_applied];
        if (step_of_frame(crowd.scene, event.frame) > step) return;
        apply_event(crowd.agents, crowd.scene, event);
    }
}

// A crowd that is small takes less time than threads to wake up.
int threads_for(const CrowdWorld& crowd) {
    constexpr std::size_t worth_it = 1000;
    return crowd.active.size() < worth_it ? 1 : crowd.threads;
}

bool has_bodies(const CrowdWorld& crowd) {
    return crowd.bodies.rule != BodyRule::none;
}

void freeze_positions(CrowdWorld& crowd) {
    crowd.positions.resize(crowd.active.size());
    for (std::size_t k = 0; k < crowd.active.size(); ++k) crowd.positions[k] = crowd.agents.position[crowd.active[k]];
}

void find_contacts(CrowdWorld& crowd, const WaterBins& water) {
    const double distance = contact_distance(crowd.scene.coupling);
    if (water.x.empty()) {
        crowd.contacts.assign(crowd.active.size(), {});
        return;
    }
    crowd.contacts.resize(crowd.active.size());
    for (std::size_t k = 0; k < crowd.active.size(); ++k) {
        crowd.contacts[k] = find_contact(water, crowd.positions[k], distance, crowd.touching);
    }
}

void choose_walking_velocities(CrowdWorld& crowd, std::uint64_t step) {
    const double period = crowd.scene.world.period();
    crowd.goal_offsets.resize(crowd.active.size());
    for (std::size_t k = 0; k < crowd.active.size(); ++k) {
        crowd.goal_offsets[k] = goal_offset(crowd.agents, crowd.active[k], period);
    }
    crowd.markers.drawn.epoch = marker_epoch(crowd.scene.crowd, step);
    Walkers walkers;
    walkers.position = crowd.positions;
    walkers.goal_offset = crowd.goal_offsets;
    if (has_bodies(crowd)) {
        prepare_bodies(crowd.bodies, walkers, crowd.agents, crowd.active, crowd.positions, crowd.goal_offsets,
                       crowd.scene.world, crowd.scene.crowd.perception_radius, looks_whom_to_follow(step, crowd.dt),
                       threads_for(crowd));
    }
    find_motion(crowd.motion, crowd.marker_memory, crowd.markers, walkers, crowd.scene.crowd.perception_radius, period,
                threads_for(crowd));
    const double marker_area = GroundGrid::cell_size * GroundGrid::cell_size / crowd.scene.crowd.markers_per_cell;
    crowd.walking.resize(crowd.active.size());
    for (std::size_t k = 0; k < crowd.active.size(); ++k) {
        const std::uint32_t id = crowd.active[k];
        const SpeedRule rule = crowd.scene.crowd.speed_rule;
        const Vector2d wish =
            has_bodies(crowd)
                ? wished_velocity(crowd.bodies, crowd.agents, id, k, crowd.motion, marker_area, rule, crowd.dt)
                : walking_velocity(crowd.motion.vector[k], crowd.agents.desired_speed[id], rule, crowd.dt);
        crowd.walking[k] = keep_in_world(crowd.scene.world, crowd.positions[k], wish, crowd.dt);
    }
}

bool is_continuous(const CrowdWorld& crowd) {
    return crowd.scene.coupling.rule == CouplingRule::continuous;
}

void couple_with_water(CrowdWorld& crowd, const WaterBins& water) {
    Agents& agents = crowd.agents;
    if (!is_continuous(crowd) && water.x.empty()) {
        crowd.velocity = crowd.walking;
        return;
    }
    crowd.velocity.resize(crowd.active.size());
    const Sampling sampling = sampling_of(crowd.scene);
    for (std::size_t k = 0; k < crowd.active.size(); ++k) {
        const std::uint32_t id = crowd.active[k];
        if (!is_continuous(crowd)) {
            crowd.velocity[k] = coupled_velocity(agents.mass[id], crowd.walking[k], agents.tau[id], crowd.contacts[k]);
            continue;
        }
        const Walker walker{crowd.positions[k], agents.momentary[id], crowd.walking[k], agents.mass[id],
                            agents.tau[id]};
        const RelaxedVelocity relaxed = sampling.samples > 1
                                            ? sampled_velocity(water, crowd.scene, sampling, walker, crowd.dt)
                                            : relaxed_velocity(walker.mass, walker.velocity, walker.walking, walker.tau,
                                                               crowd.contacts[k], crowd.dt);
        crowd.velocity[k] = relaxed.mean;
        agents.momentary[id] = relaxed.at_end;
    }
}

// What is left of a velocity where walls kept `from` + `wanted` back at `to`: nothing along an axis that they cut.
Vector2d stopped_at_walls(const Vector2d& velocity, const Vector2d& from, const Vector2d& wanted, const Vector2d& to) {
    const Vector2d free = from + wanted;
    return {to.x() == free.x() ? velocity.x() : 0, to.y() == free.y() ? velocity.y() : 0};
}

// Nobody walks over the fall at x = 0; water that pushes towards it may carry an agent over.
bool pushed_over_the_fall(double tau, const Contact& contact) {
    return tau > 0 && contact.momentum.x() < 0;
}

// Brings an agent that left a periodic world over one end in at the other.
void wrap(Vector2d& p, std::int32_t& laps, double period) {
    const double lap = std::floor(p.x() / period);
    p.x() -= lap * period;
    laps += static_cast<std::int32_t>(lap);
    if (p.x() < period) return;
    p.x() = 0;  // a step below 0 that is too small to be told from the length
    ++laps;
}

// A blow takes the part of a velocity that went against it.
Vector2d stopped_by_bodies(const Vector2d& velocity, const Vector2d& wanted, const Vector2d& way, double dt) {
    const Vector2d lost = wanted - way;
    const double length = std::sqrt(lost.squaredNorm());
    if (!(length > 0)) return velocity;
    const Vector2d n = lost / length;
    return velocity - std::max(0.0, velocity.dot(n) - way.dot(n) / dt) * n;
}

void limit_to_bodies(CrowdWorld& crowd) {
    const std::size_t n = crowd.active.size();
    crowd.wishes.resize(n);
    crowd.may_fall.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
        crowd.wishes[k] = crowd.velocity[k] * crowd.dt;
        crowd.may_fall[k] = pushed_over_the_fall(crowd.agents.tau[crowd.active[k]], crowd.contacts[k]);
    }
    limit_steps(crowd.bodies, crowd.walls, crowd.positions, crowd.wishes, crowd.may_fall, threads_for(crowd));
}

// Where agent k goes with its body, and what that does to its memory.
Vector2d step_with_body(CrowdWorld& crowd, std::size_t k) {
    const std::uint32_t id = crowd.active[k];
    const World& world = crowd.scene.world;
    const Vector2d& u = crowd.bodies.step[k];
    note_blocked(crowd.bodies, crowd.agents, id, u, crowd.dt);
    if (is_continuous(crowd)) {
        crowd.agents.momentary[id] = stopped_by_bodies(crowd.agents.momentary[id], crowd.wishes[k], u, crowd.dt);
    }
    Vector2d to = crowd.positions[k] + u;
    if (world.ends == Ends::open) to.x() = std::min(to.x(), world.length);
    if (world.ends == Ends::open && !crowd.may_fall[k]) to.x() = std::max(to.x(), 0.0);
    to.y() = std::clamp(to.y(), 0.0, world.width);
    return to;
}

void move_agents(CrowdWorld& crowd) {
    Agents& agents = crowd.agents;
    if (has_bodies(crowd)) limit_to_bodies(crowd);
    const double period = crowd.scene.world.period();
    for (std::size_t k = 0; k < crowd.active.size(); ++k) {
        const std::uint32_t id = crowd.active[k];
        const Vector2d& from = crowd.positions[k];
        const Vector2d wanted = crowd.velocity[k] * crowd.dt;
        const Vector2d to = has_bodies(crowd) ? step_with_body(crowd, k)
                                              : slide(crowd.walls, from, wanted,
                                                      pushed_over_the_fall(agents.tau[id], crowd.contacts[k]));
        if (is_continuous(crowd) && !has_bodies(crowd)) {
            agents.momentary[id] = stopped_at_walls(agents.momentary[id], from, wanted, to);
        }
        const Vector2d way = to - from;
        const double length = std::sqrt(way.squaredNorm());
        agents.position[id] = to;
        agents.velocity[id] = way / crowd.dt;
        agents.path_length[id] += length;
        if (length > 0) agents.heading[id] = way / length;
        if (period > 0) wrap(agents.position[id], agents.laps[id], period);
    }
}

Outcome judge(const CrowdWorld& crowd, std::uint32_t id) {
    const Vector2d& p = crowd.agents.position[id];
    if (p.x() < 0) return Outcome::dead;
    const double reach = crowd.scene.crowd.goal_radius;
    const Vector2d rest = goal_offset(crowd.agents, id, crowd.scene.world.period());
    return rest.squaredNorm() <= reach * reach ? Outcome::arrived : Outcome::active;
}

void judge_outcomes(CrowdWorld& crowd, std::uint64_t step) {
    for (const std::uint32_t id : crowd.active) {
        const Outcome outcome = judge(crowd, id);
        crowd.agents.outcome[id] = outcome;
        if (outcome == Outcome::active) continue;
        crowd.agents.end_step[id] = step;
        ++(outcome == Outcome::arrived ? crowd.arrived : crowd.dead);
        if (outcome == Outcome::arrived) crowd.last_arrival_step = step;
    }
    std::erase_if(crowd.active, [&](std::uint32_t id) { return crowd.agents.outcome[id] != Outcome::active; });
}

// The step, once the positions are frozen and the water round them is sorted.
void advance(CrowdWorld& crowd, const WaterBins& water) {
    const std::uint64_t this_step = crowd.steps + 1;
    apply_events_due(crowd, this_step);
    find_contacts(crowd, water);  // Eq. 5
    if (!water.x.empty()) note_water_met(crowd.agents, crowd.scene, crowd.active, crowd.positions, water);
    if (has_ragdolls(crowd.scene)) {
        find_ragdolls(crowd.ragdolls, crowd.scene, crowd.agents, crowd.active, crowd.positions, water, this_step);
    }
    choose_walking_velocities(crowd, this_step);  // Eq. 1-4
    couple_with_water(crowd, water);              // Eq. 6-9
    move_agents(crowd);
    judge_outcomes(crowd, this_step);
    crowd.steps = this_step;
}

}  // namespace

CrowdWorld make_crowd(const Scene& scene) {
    check_coupling(scene);
    CrowdWorld crowd;
    crowd.scene = scene;
    crowd.dt = 1 / scene.crowd.step_rate;
    std::stable_sort(crowd.scene.events.begin(), crowd.scene.events.end(),
                     [](const TauEvent& a, const TauEvent& b) { return a.frame < b.frame; });
    crowd.agents = make_agents(scene);
    crowd.active.resize(crowd.agents.size());
    std::iota(crowd.active.begin(), crowd.active.end(), 0U);
    crowd.walls = make_walls(scene);
    move_out_of_faces(crowd.agents, crowd.walls);
    if (scene.crowd.bodies != BodyRule::none) {
        crowd.bodies.rule = scene.crowd.bodies;
        crowd.bodies.style = body_style(scene.crowd.bodies);
        crowd.bodies.radius = scene.crowd.body_radius;
        make_room_for_bodies(crowd.agents, crowd.walls, scene.crowd.body_radius);
    }
    crowd.markers = crowd.agents.size() == 0 ? Markers{} : place_markers(scene);
    crowd.markers.grid = GroundGrid::over(scene.world);
    crowd.markers.cell_start.resize(crowd.markers.grid.cells() + 1);
    crowd.water = empty_bins(scene);
    return crowd;
}

void step(CrowdWorld& crowd, const WaterView& water) {
    freeze_positions(crowd);
    bin_water(crowd.water, water, crowd.positions);
    advance(crowd, crowd.water);
}

void step_through(CrowdWorld& crowd, const WaterBins& water) {
    freeze_positions(crowd);
    advance(crowd, water);
}

}  // namespace wade::crowd
