#include "crowd_client/outputs/writers/report.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "configs/json/json.hpp"
#include "configs/loading/scene_loader.hpp"
#include "configs/program/version.hpp"
#include "configs/scene/choices.hpp"
#include "configs/scene/crowd.hpp"
#include "crowd_client/crowd_motion.hpp"
#include "crowd_client/rescue.hpp"
#include "crowd_client/results/output_file.hpp"
#include "crowd_client/standing.hpp"
#include "crowd_client/water/water_met.hpp"

namespace wade::crowd {
namespace {

template <typename T>
Json or_null(const std::optional<T>& value) {
    return value ? Json(*value) : Json(nullptr);
}

double time_of(const CrowdWorld& crowd, std::uint64_t step) {
    return static_cast<double>(step) / crowd.scene.crowd->step_rate;
}

Json hash_or_null(std::uint64_t hash) {
    return hash != 0 ? Json(hash_text(hash)) : Json(nullptr);
}

// A counter that the producer may not give: 0 means missing, unless the producer gave other figures.
Json counter(std::uint64_t value, bool given) {
    return given ? Json(value) : Json(nullptr);
}

Json fluid_json(const RunSummary& summary, const RunLabels& labels) {
    const FluidSummary& fluid = summary.fluid;
    const bool has_solver = fluid.steps > 0;
    Json json;
    json["model"] = labels.model.empty() ? Json(nullptr) : Json(labels.model);
    json["particles_max"] = fluid.particles_max;
    json["particle_steps"] = counter(fluid.particle_steps, has_solver);
    json["steps"] = counter(fluid.steps, has_solver);
    json["solver_wall_s"] = nullptr;
    if (!labels.reproducible && fluid.solver_ns > 0)
        json["solver_wall_s"] = static_cast<double>(fluid.solver_ns) * 1e-9;
    json["mean_depth_m"] = or_null(fluid.depth.value());
    json["mean_speed_m_s"] = or_null(fluid.speed.value());
    json["max_density_error"] = or_null(fluid.max_density_error);
    json["mean_density_error"] = or_null(fluid.density_error.value());
    json["position_clamps"] = counter(fluid.position_clamps, has_solver);
    json["recycled_particles"] = counter(fluid.recycled_particles, has_solver);
    json["resident_bytes"] = counter(fluid.resident_bytes, fluid.resident_bytes > 0 && !labels.reproducible);
    return json;
}

// RFC 4180.
std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"') quoted += '"';
        quoted += c;
    }
    return quoted + '"';
}

// Bytes that are no UTF-8, for example in a file name, become a replacement character instead of an error.
std::string text_of(const Json& json) {
    return json.dump({.indent = 2, .lossy_text = true}) + "\n";
}

// How many agents are in each state.
Json states_json(const CrowdWorld& crowd) {
    Json states;
    for (const std::string_view name : state_names(crowd.scene)) states[std::string(name)] = 0;
    for (std::size_t id = 0; id < crowd.agents.size(); ++id) {
        Json& count = states[std::string(state_name(crowd, id))];
        count = count.get<std::size_t>() + 1;
    }
    return states;
}

// Counts the people that were on their feet and strained in water beyond the range of the flumes, and sums up their
// time.
Json beyond_json(const People& people) {
    const auto is_beyond = [](double time) { return time > 0; };
    return {{"people", std::count_if(people.beyond.begin(), people.beyond.end(), is_beyond)},
            {"time_s", std::accumulate(people.beyond.begin(), people.beyond.end(), 0.0)}};
}

// Returns the worst state of a person that responds by body; empty for a person with a given tau.
std::string_view worst_state(const People& people, std::size_t id) {
    return people.by_body[id] != 0 ? person_states[static_cast<std::size_t>(people.worst[id])] : "";
}

// Returns how the last drift ended; "adrift" while it goes on.
std::string_view drift_end(const CrowdWorld& crowd, std::size_t id) {
    const Condition& condition = crowd.agents.people.condition[id];
    switch (condition.drift.end) {
        case DriftEnd::none:
            return "";
        case DriftEnd::feet_down:
            return "feet_down";
        case DriftEnd::got_up:
            return "got_up";
        case DriftEnd::held:
            return "held";
        case DriftEnd::pinned:
            return "pinned";
        case DriftEnd::adrift:
            break;
    }
    if (condition.state == PersonState::drowned) return "drowned";
    const Outcome outcome = crowd.agents.outcome[id];
    return outcome == Outcome::dead ? "swept_away" : outcome == Outcome::arrived ? "arrived" : "adrift";
}

// Time adrift, exposure to drowning, the end of the last drift, the ability to swim, the longest time at rest off the feet and the
// state then, with the response `measured`.
std::string drift_columns(const CrowdWorld& crowd, std::size_t id) {
    const People& people = crowd.agents.people;
    if (people.by_body[id] == 0) return ",,,,,,";
    const Drift& drift = people.condition[id].drift;
    const Stop& stop = people.stop[id];
    const std::string_view state = stop.longest > 0 ? person_states[static_cast<std::size_t>(stop.state)] : "";
    return ',' + csv_number(drift.time) + ',' + csv_number(drift.exposure) + ',' + std::string(drift_end(crowd, id)) +
           (people.can_swim[id] != 0 ? ",1," : ",0,") + csv_number(stop.longest) + ',' + std::string(state);
}

}  // namespace

std::string outcome_json(const CrowdWorld& crowd, const RunSummary& summary, const RunLabels& labels) {
    Json json;
    json["scene"] = crowd.scene.name;
    json["seed"] = crowd.scene.seed;
    json["status"] = summary.status;
    json["message"] = summary.message.empty() ? Json(nullptr) : Json(summary.message);
    json["mode"] = labels.latest_frames ? "latest" : "lockstep";
    json["frames"] = summary.frames;
    json["dropped_frames"] = summary.dropped_frames;
    json["frame_rate_hz"] = crowd.scene.frame_rate;
    json["steps"] = crowd.steps;
    json["step_rate_hz"] = crowd.scene.crowd->step_rate;
    json["sim_time_s"] = time_of(crowd, crowd.steps);
    json["wall_time_s"] = labels.reproducible ? Json(nullptr) : or_null(labels.wall_time);
    json["agents"] = crowd.agents.size();
    json["arrived"] = crowd.arrived;
    json["dead"] = crowd.dead;
    json["active"] = crowd.active.size();
    if (crowd.scene.site) {
        json["sheltered"] = crowd.sheltered;
        json["indoors"] = crowd.indoors.inside;
        json["upper_floor"] = crowd.indoors.upstairs;
        json["indoors_behind_deep_water"] = count_behind_deep_water(crowd);
    }
    json["standing"] = count_standing(crowd);
    json["states"] = states_json(crowd);
    if (crowd.scene.crowd->response == ResponseKind::measured) {
        json["walking_in_water"] = name_of(crowd.scene.crowd->walking_in_water);
        json["beyond_measured"] = beyond_json(crowd.agents.people);
    }
    if (const RescueCount rescue = count_rescues(crowd); rescue.rescuers > 0) {
        json["rescue"] = {
            {"rescuers", rescue.rescuers}, {"saved", rescue.saved}, {"rescuers_lost_feet", rescue.lost_feet}};
    }
    std::vector<std::string> warnings = crowd.warnings;
    if (std::string deep = warning_of_deep_water(crowd); !deep.empty()) warnings.push_back(std::move(deep));
    json["warnings"] = warnings;
    json["last_arrival_s"] = crowd.arrived > 0 ? Json(time_of(crowd, crowd.last_arrival_step)) : Json(nullptr);
    json["contact_rule"] = name_of(crowd.scene.coupling->contact_rule);
    json["momentum_balance_n_s"] = summary.momentum ? Json(summary.momentum->difference()) : Json(nullptr);
    if (summary.momentum) {
        const auto along = [](const Vector2d& v) { return Json{v.x(), v.y()}; };
        json["momentum"] = {{"people_got_n_s", along(summary.momentum->got)},
                            {"water_lost_n_s", along(summary.momentum->lost)},
                            {"water_had_not_n_s", along(summary.momentum->missing)}};
    }
    json["fluid"] = fluid_json(summary, labels);
    json["frame_hash"] = hash_or_null(summary.frame_hash);
    json["agents_hash"] = hash_or_null(summary.agents_hash);
    return text_of(json);
}

std::string agents_csv(const CrowdWorld& crowd, const DangerRecord* danger) {
    const Agents& agents = crowd.agents;
    std::string csv =
        "id,group,outcome,time_s,x_m,z_m,tau,mass_kg,path_length_m,max_depth_m,max_dv_m2_s,mean_depth_m,"
        "mean_dv_m2_s,state,height_m,mean_tau,worst_state,age,skill,"
        "sex,ground_friction,bracing_arm,start_x_m,start_z_m,off_feet_s,door_depth_m,adrift_s,exposure_s,drift_end,can_"
        "swim,rest_s,rest_state";
    if (!agents.resident.empty()) csv += ",resident";
    if (danger != nullptr) csv.append(",danger_level,").append(exposure_columns);
    csv += '\n';
    for (std::size_t id = 0; id < agents.size(); ++id) {
        const Outcome outcome = agents.outcome[id];
        const bool active =
            outcome == Outcome::active || outcome == Outcome::indoors || outcome == Outcome::upper_floor;
        csv += std::to_string(id) + ',' + csv_field(crowd.scene.crowd->groups[agents.group[id]].name) + ',';
        csv += outcome_name(agents.outcome[id]);
        const double time =
            active ? time_of(crowd, crowd.steps) : time_of(crowd, agents.end_step[id]) - agents.end_before[id];
        for (const double v : {time, agents.position[id].x(), agents.position[id].y(), agents.tau[id], agents.mass[id],
                               agents.path_length[id], agents.max_depth[id], agents.max_dv[id],
                               mean_depth_met(agents, id), mean_dv_met(agents, id)}) {
            csv += ',' + csv_number(v);
        }
        csv += ',' + std::string(state_name(crowd, id)) + ',' + csv_number(agents.people.height[id]);
        csv += ',' + csv_number(mean_tau_met(agents, id)) + ',' + std::string(worst_state(agents.people, id));
        csv += ',' + csv_number(agents.people.age[id]) + ',' + std::string(name_of(agents.people.skill[id]));
        csv += agents.people.sex[id] == Sex::male ? ",male" : ",female";
        csv += ',' + csv_number(agents.people.friction[id]);
        csv += ',' + csv_number(agents.people.arm[id] / agents.people.height[id]);
        csv += ',' + csv_number(agents.start[id].x()) + ',' + csv_number(agents.start[id].y()) + ',';
        if (const std::uint64_t lost = agents.lost_feet_step[id]; lost > 0) csv += csv_number(time_of(crowd, lost));
        csv += ',';
        if (!agents.door_depth.empty()) csv += csv_number(agents.door_depth[id]);
        csv += drift_columns(crowd, id);
        if (!agents.resident.empty()) csv += ',' + (id < agents.resident.size() ? csv_field(agents.resident[id]) : "");
        if (danger != nullptr) {
            const Exposure& met = danger->agents()[id];
            csv += ',' + std::string(danger_name(met.largest)) + ',' + exposure_times(met, crowd.dt);
        }
        csv += '\n';
    }
    return csv;
}

std::string crowds_csv_row(const CrowdWorld& crowd, const RunSummary& summary) {
    std::string row = std::to_string(crowd.scene.seed) + ',' + summary.status;
    for (const std::size_t n : {crowd.agents.size(), crowd.arrived, crowd.dead, crowd.active.size(), crowd.sheltered,
                                crowd.indoors.inside, crowd.indoors.upstairs}) {
        row += ',' + std::to_string(n);
    }
    row += ',' + (crowd.arrived > 0 ? csv_number(time_of(crowd, crowd.last_arrival_step)) : "");
    return row + ',' + csv_field(summary.message);
}

std::string manifest_json(const CrowdWorld& crowd, const RunSummary& summary, const RunLabels& labels) {
    Json json;
    json["program"] = "crowd_client";
    json["version"] = version();
    json["git_hash"] = git_hash();
    json["compiler"] = compiler();
    json["scene"] = crowd.scene.name;
    json["scene_hash"] = hash_text(crowd.scene.hash);
    json["seed"] = crowd.scene.seed;
    json["threads"] = labels.threads;
    json["status"] = summary.status;
    json["command_line"] = labels.command_line;
    if (!labels.reproducible) {
        json["session"] = labels.session;
        json["host"] = labels.host;
        json["started_at"] = labels.started_at;
        json["wall_time_s"] = or_null(labels.wall_time);
    }
    json["resolved_scene"] = Json::try_parse(labels.canonical_scene).value_or(Json());
    return text_of(json);
}

}  // namespace wade::crowd
