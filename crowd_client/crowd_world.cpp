#include "crowd_client/crowd_world.hpp"

#include <algorithm>

#include "configs/scene/scene_frames.hpp"
#include "crowd_client/crowd_motion.hpp"
#include "crowd_client/water/contacts.hpp"
#include "crowd_client/water/sampled_coupling.hpp"
#include "crowd_client/water/water_met.hpp"
#include "crowd_client/ways/evasion.hpp"

namespace wade::crowd {
namespace {

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

void choose_walking_velocities(CrowdWorld& crowd, const WaterBins& water, std::uint64_t step) {
    const double period = crowd.scene.world.period();
    crowd.goal_offsets.resize(crowd.active.size());
    for (std::size_t k = 0; k < crowd.active.size(); ++k) {
        crowd.goal_offsets[k] = goal_offset(crowd.agents, crowd.active[k], period);
    }
    if (finds_ways(crowd.navigation)) {
        update_navigation(crowd.navigation, crowd.positions, step, crowd.threads);
        steer(crowd.navigation, crowd.active, crowd.positions, crowd.goal_offsets, threads_for(crowd));
    }
    if (crowd.scene.crowd.evasion.rule != EvasionRule::off && !water.x.empty()) {
        evade(crowd.scene.crowd.evasion, crowd.agents, crowd.active, crowd.positions, water, crowd.goal_offsets);
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
    choose_walking_velocities(crowd, water, this_step);  // Eq. 1-4
    couple_with_water(crowd, water);                     // Eq. 6-9
    move_agents(crowd);
    judge_outcomes(crowd, this_step);
    crowd.steps = this_step;
}

}  // namespace

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
