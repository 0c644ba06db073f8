#include "crowd_client/crowd_world.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/scene_frames.hpp"
#include "configs/scene/time_lines.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/crowd_motion.hpp"
#include "crowd_client/hands.hpp"
#include "crowd_client/navigation/evasion.hpp"
#include "crowd_client/rescue.hpp"
#include "crowd_client/standing.hpp"
#include "crowd_client/water/contacts.hpp"
#include "crowd_client/water/water_met.hpp"

namespace wade::crowd {
namespace {

// Arguments of a stage: the crowd, the water near it, the current step and its part.
struct Step {
    CrowdWorld& crowd;
    const WaterBins& water;
    std::uint64_t number;
    int part = 0;
    bool decides = true;  // agents choose where to walk, else they keep the last choice
    Decision decision = {};
    [[nodiscard]] bool is_wet() const { return !water.x.empty(); }
};

void apply_event(Agents& agents, const Scene& scene, const TauEvent& event) {
    for (std::size_t id = 0; id < agents.size(); ++id) {
        const bool by_id = !event.agent || static_cast<std::size_t>(*event.agent) == id;
        const bool by_group = !event.group || scene.crowd->groups[agents.group[id]].name == *event.group;
        if (!by_id || !by_group) continue;
        agents.tau[id] = event.tau;
        agents.people.by_body[id] = 0;
        std::erase_if(agents.tau_lines, [id](const TauLine& line) { return line.id == id; });
    }
}

// Sets tau of agents with a tau that changes in time, at the end of the step.
void follow_tau_lines(Agents& agents, double time) {
    for (const TauLine& line : agents.tau_lines) agents.tau[line.id] = value_at(*line.points, &TauPoint::tau, time);
}

void apply_events_due(const Step& step) {
    CrowdWorld& crowd = step.crowd;
    const std::vector<TauEvent>& events = crowd.scene.events;
    for (; crowd.events_applied < events.size(); ++crowd.events_applied) {
        const TauEvent& event = events[crowd.events_applied];
        if (step_of_frame(crowd.scene, event.frame) > step.number) break;
        apply_event(crowd.agents, crowd.scene, event);
    }
    follow_tau_lines(crowd.agents, static_cast<double>(step.number) * crowd.dt);
}

void find_contacts(const Step& step) {
    CrowdWorld& crowd = step.crowd;
    if (!step.is_wet()) {
        crowd.contacts.assign(crowd.active.size(), {});
        return;
    }
    const double distance = contact_distance(crowd.scene.coupling);
    crowd.contacts.resize(crowd.active.size());
    for (std::size_t k = 0; k < crowd.active.size(); ++k) {
        if (crowd.agents.people.by_body[crowd.active[k]] != 0) {
            crowd.contacts[k] = {};
            continue;
        }
        crowd.contacts[k] = find_contact(step.water, crowd.positions[k], distance, crowd.touching);
    }
}

FeltStep felt_step(const CrowdWorld& crowd, std::size_t k, const Step& step) {
    FeltStep felt{crowd.felt[k].depth, crowd.felt[k].velocity, crowd.part_time, step.number == 1 && step.part == 0};
    if (crowd.scene.coupling->shelter == Shelter::wake) felt.lee = crowd.shelters.lee[k];
    return felt;
}

WaterProperties water_of(const Scene& scene) {
    return {scene.fluid->rest_density, scene.world->gravity};
}

// Calls visit(k, id) for each active agent that responds by body.
template <typename Visit>
void for_each_by_body(const CrowdWorld& crowd, Visit&& visit) {
    if (crowd.scene.crowd->response != ResponseKind::measured) return;
    for (std::size_t k = 0; k < crowd.active.size(); ++k) {
        if (crowd.agents.people.by_body[crowd.active[k]] != 0) visit(k, crowd.active[k]);
    }
}

void find_felt_water(const Step& step) {
    CrowdWorld& crowd = step.crowd;
    if (!crowd.feeling) return;
    feel_water(*crowd.feeling, step.water, crowd.positions, threads_for(crowd), crowd.felt);
    if (crowd.scene.coupling->two_way) note_discs(crowd.scene, *crowd.feeling, crowd.active, crowd.felt, crowd.agents);
    if (crowd.scene.coupling->shelter == Shelter::wake) {
        shelter(crowd.scene, crowd.agents, crowd.active, crowd.positions, crowd.shelters, crowd.felt);
    }
    Agents& agents = crowd.agents;
    for_each_by_body(crowd, [&](std::size_t k, std::uint32_t id) {
        feel(agents.people, id, felt_step(crowd, k, step));
        agents.desired_speed[id] = waits(crowd, id)
                                       ? 0
                                       : speed_in_water(agents.people, id, agents.mass[id],
                                                        crowd.scene.crowd->walking_in_water, water_of(crowd.scene));
    });
    if (!crowd.links.empty()) share_speeds_of_files(crowd);
}

void judge_footing(const Step& step) {
    CrowdWorld& crowd = step.crowd;
    Agents& agents = crowd.agents;
    const WaterProperties water = water_of(crowd.scene);
    for_each_by_body(crowd, [&](std::size_t k, std::uint32_t id) {
        note_condition(agents.people, id, agents.mass[id], agents.momentary[id], crowd.walking[k], water,
                       felt_step(crowd, k, step));
        agents.tau[id] = tau_of(agents.people.slip[id]);
        const bool on_feet = agents.people.worst[id] < PersonState::toppled;
        if (!on_feet && agents.lost_feet_step[id] == 0) agents.lost_feet_step[id] = step.number;
    });
}

void judge_density(CrowdWorld& crowd, const WaterBins& water) {
    if (!crowd.density) return;
    if (const auto warning = crowd.density->look(water, crowd.positions)) crowd.warnings.push_back(*warning);
    if (crowd.density->is_decided()) crowd.density.reset();
}

void note_water(const Step& step) {
    CrowdWorld& crowd = step.crowd;
    if (step.is_wet()) judge_density(crowd, step.water);
    if (step.is_wet()) note_water_met(crowd.agents, crowd.scene, crowd.active, crowd.positions, step.water);
}

void tumble(const Step& step) {
    CrowdWorld& crowd = step.crowd;
    if (!has_ragdolls(crowd.scene)) return;
    find_ragdolls(crowd.ragdolls, crowd.tumbling, crowd.scene, crowd.agents, crowd.active, crowd.positions, step.water,
                  step.number);
}

void go_straight(CrowdWorld& crowd) {
    crowd.goal_offsets.resize(crowd.active.size());
    for (std::size_t k = 0; k < crowd.active.size(); ++k) {
        crowd.goal_offsets[k] = goal_offset(crowd.agents, crowd.active[k], crowd.scene.world->period());
    }
}

void solve_fields(const Step& step) {
    CrowdWorld& crowd = step.crowd;
    if (crowd.navigation.site) {
        if (are_site_routes_due(crowd.navigation, step.number)) {
            update_site_routes(crowd.navigation, crowd.scene, step.water, crowd.threads);
            note_depth_at_doors(crowd);
        }
        if (!crowd.active.empty()) solve_due_fields(crowd.navigation, crowd.positions, crowd.threads);
        return;
    }
    if (!is_due(crowd.navigation, step.number)) return;
    go_straight(crowd);
    update_navigation(crowd.navigation, crowd.scene, crowd.active, crowd.positions, crowd.goal_offsets, crowd.threads);
}

// Sends the rescuers by the water of this step; a rescuer that stops has a desired speed of 0 from this stage on.
void send(const Step& step) {
    send_rescuers(step.crowd, step.water);
    for (const Rescuer& one : step.crowd.rescues.rescuers) {
        if (one.stands) step.crowd.agents.desired_speed[one.id] = 0;
    }
}

void find_routes(const Step& step) {
    CrowdWorld& crowd = step.crowd;
    go_straight(crowd);
    if (crowd.navigation.site) {
        steer_in_site(crowd.navigation, crowd.agents, crowd.active, crowd.positions, crowd.goal_offsets,
                      step.decision.number, threads_for(crowd));
    } else if (finds_routes(crowd.navigation)) {
        steer(crowd.navigation, crowd.active, crowd.positions, crowd.goal_offsets, step.decision.number,
              threads_for(crowd));
    }
    const EvasionSettings& evasion = crowd.scene.crowd->evasion;
    if (evasion.rule != EvasionRule::off && step.is_wet()) {
        evade(evasion, crowd.agents, crowd.active, crowd.positions, step.water, crowd.goal_offsets);
    }
    lead_rescued(crowd);
}

void compete_for_markers(const Step& step) {
    CrowdWorld& crowd = step.crowd;
    const Crowd& settings = crowd.scene.crowd;
    const double radius = settings.perception_radius;
    redraw(crowd.markers.drawn,
           settings.marker_epoch > 0 ? marker_epoch(settings, step.number) : step.decision.number + 1);
    Walkers walkers;
    walkers.position = crowd.positions;
    walkers.goal_offset = crowd.goal_offsets;
    if (has_bodies(crowd)) {
        prepare_bodies(crowd.bodies, walkers, crowd.agents, crowd.active, crowd.positions, crowd.goal_offsets,
                       crowd.scene.world, radius, step.decision, threads_for(crowd));
    }
    find_motion(crowd.motion, crowd.marker_memory, crowd.markers, walkers, radius, crowd.scene.world->period(),
                threads_for(crowd));
}

void choose_walking_velocities(const Step& step) {
    CrowdWorld& crowd = step.crowd;
    const SpeedRule rule = crowd.scene.crowd->speed_rule;
    const double marker_area = GroundGrid::cell_size * GroundGrid::cell_size / crowd.scene.crowd->markers_per_cell;
    crowd.walking.resize(crowd.active.size());
    for (std::size_t k = 0; k < crowd.active.size(); ++k) {
        const std::uint32_t id = crowd.active[k];
        if (has_bodies(crowd) && step.decides) {
            crowd.agents.body.intended[id] =
                wished_velocity(crowd.bodies, crowd.agents, id, k, crowd.motion, marker_area, rule, step.decision);
        }
        Vector2d wish = has_bodies(crowd) ? crowd.agents.body.intended[id]
                                          : walking_velocity(crowd.motion.vector[k], crowd.agents.desired_speed[id],
                                                             rule, crowd.part_time);
        wish *= share_on_ground(crowd.navigation, id, crowd.positions[k], wish);
        crowd.walking[k] = keep_in_world(crowd.scene.world, crowd.positions[k], wish, crowd.part_time);
    }
    if (!crowd.links.empty()) walk_in_files(crowd);
}

void respond_to_water(const Step& step) {
    CrowdWorld& crowd = step.crowd;
    crowd.response->respond({crowd.scene, crowd.part_time, crowd.agents, crowd.active, crowd.positions, crowd.walking,
                             crowd.contacts, step.water, crowd.felt},
                            crowd.next);
}

void hold(const Step& step) {
    hold_hands(step.crowd);
}

void move(const Step& step) {
    move_agents(step.crowd);
}

void push(const Step& step) {
    CrowdWorld& crowd = step.crowd;
    if (!crowd.pushing) return;
    push_water(crowd.scene, crowd.agents, crowd.active, crowd.felt, crowd.next.push, crowd.part_time, *crowd.pushing);
}

// Returns true if the water sweeps an agent with a given tau away: while ragdoll.csv lists the agent and it is in
// water. In a scene without ragdolls the rule is local_speed with the sampled flow.
bool is_swept(CrowdWorld& crowd, std::uint32_t id) {
    constexpr double wet = 0.1;  // m; on a bank the stream beside the agent may touch it, too
    Pose& pose = crowd.poses[id];
    if (!crowd.tumbling.empty()) return crowd.tumbling[id].enabled.holds && pose.depth >= wet;
    RagdollRule rule;
    rule.condition = RagdollCondition::local_speed;
    const CellWater felt{pose.depth, std::sqrt(mean_stream(pose).squaredNorm())};
    const bool holds = pose.depth >= wet && ragdoll_holds(rule, crowd.agents.tau[id], 0, felt);
    note(pose.swept, holds, crowd.part_time);
    return pose.swept.holds;
}

void pose(const Step& step) {
    CrowdWorld& crowd = step.crowd;
    if (crowd.poses.empty()) return;
    const Agents& agents = crowd.agents;
    for (std::size_t k = 0; k < crowd.active.size(); ++k) {
        const std::uint32_t id = crowd.active[k];
        const bool swept = agents.people.by_body[id] == 0 && is_swept(crowd, id);
        const Posture posture = posture_of(agents.people, id, swept);
        const double spin = has_ground(posture) ? 0 : spin_of_water(*crowd.feeling, step.water, crowd.positions[k]);
        advance_pose(crowd.poses[id], agents.people, id, posture,
                     {crowd.part_time, crowd.felt[k].depth, crowd.felt[k].velocity, spin, agents.velocity[id],
                      crowd.walking[k], agents.mass[id], water_of(crowd.scene)});
    }
}

void look_who_stands(const Step& step) {
    note_standing(step.crowd, step.number);
}

// Returns the outcome of agent k, but for arrival at a shelter.
Outcome judge(const CrowdWorld& crowd, std::size_t k) {
    const std::uint32_t id = crowd.active[k];
    const Vector2d& p = crowd.agents.position[id];
    const bool may_drown = crowd.scene.crowd->response == ResponseKind::measured;
    if (p.x() < 0 || leaves_with_water(crowd, k) ||
        (may_drown && crowd.agents.people.condition[id].state == PersonState::drowned))
        return Outcome::dead;
    if (goes_to_shelters(crowd, id)) return Outcome::active;
    const double reach = crowd.scene.crowd->goal_radius;
    const Vector2d rest = goal_offset(crowd.agents, id, crowd.scene.world->period());
    return rest.squaredNorm() <= reach * reach && !is_on_duty(crowd, id) ? Outcome::arrived : Outcome::active;
}

void judge_outcomes(const Step& step) {
    CrowdWorld& crowd = step.crowd;
    bool all_go_on = true;
    for (std::size_t k = 0; k < crowd.active.size(); ++k) {
        const std::uint32_t id = crowd.active[k];
        Outcome outcome = judge(crowd, k);
        if (outcome == Outcome::active && goes_to_shelters(crowd, id)) outcome = come_to_shelter(crowd, id);
        crowd.agents.outcome[id] = outcome;
        if (outcome == Outcome::active) continue;
        all_go_on = false;
        crowd.agents.end_step[id] = step.number;
        crowd.agents.end_before[id] = (crowd.clock.parts - 1 - step.part) * crowd.part_time;
        ++(outcome == Outcome::arrived ? crowd.arrived : outcome == Outcome::dead ? crowd.dead : crowd.sheltered);
        if (outcome == Outcome::arrived) crowd.last_arrival_step = step.number;
    }
    if (all_go_on) return;
    std::erase_if(crowd.active, [&](std::uint32_t id) { return crowd.agents.outcome[id] != Outcome::active; });
}

enum class When : std::uint8_t { in_each_part, once, at_decisions };

struct Stage {
    std::string_view name;
    void (*run)(const Step&);
    When when = When::in_each_part;
};

// The stages of a step, after the positions are frozen and the water round them is sorted. Each stage reads the results
// of the stages before it and the agents of the last step; `motion` writes the next state of all agents.
constexpr std::array stages{
    Stage{"events", apply_events_due, When::once},
    Stage{"contacts", find_contacts},  // Eq. 5
    Stage{"felt water", find_felt_water},
    Stage{"water met", note_water, When::once},
    Stage{"ragdolls", tumble, When::once},
    Stage{"fields", solve_fields, When::once},
    Stage{"rescue", send, When::once},
    Stage{"ways", find_routes, When::at_decisions},
    Stage{"markers", compete_for_markers, When::at_decisions},  // Eq. 1-3
    Stage{"walking", choose_walking_velocities},                // Eq. 4
    Stage{"footing", judge_footing},
    Stage{"response", respond_to_water},  // Eq. 6-9
    Stage{"hands", hold},
    Stage{"motion", move},
    Stage{"push", push},
    Stage{"poses", pose},
    Stage{"standing", look_who_stands, When::once},
    Stage{"outcomes", judge_outcomes},
};

void freeze_positions(CrowdWorld& crowd) {
    crowd.positions.resize(crowd.active.size());
    for (std::size_t k = 0; k < crowd.active.size(); ++k) crowd.positions[k] = crowd.agents.position[crowd.active[k]];
}

void walk_part(const Step& step) {
    CrowdWorld& crowd = step.crowd;
    freeze_positions(crowd);
    for (std::size_t i = 0; i < stages.size(); ++i) {
        if (stages[i].when == When::once && step.part > 0) continue;
        if (stages[i].when == When::at_decisions && !step.decides) continue;
        timed(crowd.times.get(), 1 + i, [&] { stages[i].run(step); });
    }
}

// Divides a long step into parts (body_clock.hpp).
void advance(CrowdWorld& crowd, const WaterBins& water) {
    const BodyClock& clock = crowd.clock;
    const auto parts = static_cast<std::uint64_t>(clock.parts);
    crowd.part_time = crowd.dt / clock.parts;
    Step step{crowd, water, crowd.steps + 1};
    step.decision.time = crowd.part_time * static_cast<double>(clock.steps_between);
    for (step.part = 0; step.part < clock.parts; ++step.part) {
        const std::uint64_t before = crowd.steps * parts + static_cast<std::uint64_t>(step.part);
        step.decides = before % clock.steps_between == 0;
        step.decision.number = before / clock.steps_between;
        walk_part(step);
    }
    crowd.steps = step.number;
    if (crowd.times) ++crowd.times->steps;
}

}  // namespace

void step(CrowdWorld& crowd, const WaterView& water) {
    let_out(crowd);
    freeze_positions(crowd);
    timed(crowd.times.get(), 0, [&] {
        if (needs_all_water(crowd)) return bin_all_water(crowd.water, water);
        bin_water(crowd.water, water, crowd.positions);
    });
    advance(crowd, crowd.water);
}

void step_through(CrowdWorld& crowd, const WaterBins& water) {
    let_out(crowd);
    advance(crowd, water);
}

std::vector<std::string_view> stage_names() {
    std::vector<std::string_view> names{"sorting the water"};
    for (const Stage& stage : stages) names.push_back(stage.name);
    return names;
}

}  // namespace wade::crowd
