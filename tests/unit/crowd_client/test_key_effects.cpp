// Each key of /crowd acts on a channel and on a site, or the list of keys says that it does not (Acting of fields.hpp).
//
// A few people walk through made-up water with two values of the key. A key that is declared as idle leaves the state as it is,
// bit for bit; any other key changes the state, or the scene is refused with its name.

#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "configs/loading/scene_loader.hpp"
#include "configs/scene/keys.hpp"
#include "configs/scene/scene_frames.hpp"
#include "crowd_client/crowd_world.hpp"
#include "made_up_water.hpp"

namespace wade::crowd::key_effects_test {

using namespace wade::crowd::testing;
using Assignments = std::vector<std::string>;

const std::string people = R"("groups": [
    {"name": "a", "columns": 3, "rows": 2, "start": {"x_m": 24, "z_m": 9}, "goal": {"x_m": 4, "z_m": 9}},
    {"name": "b", "columns": 2, "rows": 2, "start": {"x_m": 30, "z_m": 4.5, "pitch_x_m": 0.7}, "goal": {"x_m": 4, "z_m": 16}}])";

const std::string channel = R"({"frame_rate_hz": 10, "duration_s": 60, "world": {"length_m": 40, "width_m": 20},
    "channel": {"x_min_m": 0, "x_max_m": 40, "z_min_m": 6, "z_max_m": 14, "flow": "recirculating", "initial_river": "filled",
                "velocity_m_s": 1, "depth_m": 1},
    "obstacles": [{"x_min_m": 16, "x_max_m": 18, "z_min_m": 7, "z_max_m": 11, "height_m": 2}],
    "fluid": {"particle_spacing_m": 0.4}, "crowd": {)";

const std::string site = R"({"frame_rate_hz": 10, "duration_s": 60, "world": {"length_m": 40, "width_m": 20},
    "site": {"ground": {"level_m": 0, "slope_z": 0.05},
              "houses": [{"polygon": [[20, 14], [28, 14], [28, 19], [20, 19]], "residents": 8, "upper_floor_m": 3}],
              "shelters": [{"name": "school", "polygon": [[1, 14], [5, 14], [5, 19], [1, 19]]}]},
    "crowd": {"navigation": {"enters_up_to_m": 2}, "groups": [
        {"name": "a", "columns": 3, "rows": 2, "start": {"x_m": 24, "z_m": 4}, "goal": {"x_m": 4, "z_m": 12}, "warned": false},
        {"name": "b", "start": {"from": "houses"}, "goal": {"to": "shelters"}},
        {"name": "c", "columns": 2, "start": {"x_m": 30, "z_m": 4}, "goal": {"to": "shelters"}}], )";

// A scene, and the water that people in it meet.
struct Base {
    std::string text;
    double depth, speed;
    bool is_site;
};

const std::vector<Base>& bases() {
    static const std::vector<Base> all{
        {channel + R"("tau": 0.2, )" + people + "}}", 0.8, 1, false},
        {channel + R"("response": "measured", )" + people + "}}", 0.8, 1, false},
        {channel + R"("response": "measured", )" + people + "}}", 1.6, 0.2, false},
        {site + R"("tau": 0.2}})", 0.8, 1, true},
        {site + R"("response": "measured"}})", 0.8, 1, true},
        {site + R"("response": "measured"}})", 1.6, 0.2, true},
    };
    return all;
}

// How a key is tried: with another value, beside other keys that let it act.
struct Trial {
    std::string value;  // empty: any other
    Assignments beside = {};
    int steps = 40;
};

const std::string history = R"([{"time_s":0,"tau":0.2},{"time_s":3,"tau":0.9}])";
const Assignments with_human_bodies{"/crowd/bodies=human", "/crowd/markers=redrawn"};
const std::string rope = R"(/crowd/ropes=[{"from":{"x_m":22,"z_m":7},"to":{"x_m":22,"z_m":13}}])";
const std::string loose_rope = R"(/crowd/ropes=[{"from":{"x_m":27,"z_m":10},"free_length_m":6}])";
Assignments leaves_by(const std::string& rule) {
    return {R"(/crowd/groups/1/leaves={"rule":")" + rule +
            R"(","mean_s":2,"sd_s":1,"scale_s":2,"table":[{"time_s":2,"share":0.9}]})"};
}

const std::map<std::string, std::vector<Trial>>& trials() {
    static const std::map<std::string, std::vector<Trial>> all{
        {"/crowd/drift_hazard_per_s", {{"1", {}, 300}}},
        {"/crowd/air_budget_s", {{"40"}}},
        {"/crowd/water_temperature_c", {{"5"}}},
        {"/crowd/helping",
         {{"true", {R"(/crowd/people=[{"height_m":1.2,"mass_kg":30,"age":9},{"height_m":2,"mass_kg":120}])"}, 100}}},
        {"/crowd/ropes/*/from/x_m", {{"25", {rope}, 100}}},
        {"/crowd/ropes/*/from/z_m", {{"6", {rope}, 100}}},
        {"/crowd/ropes/*/to/x_m", {{"24", {rope}, 100}}},
        {"/crowd/ropes/*/to/z_m", {{"10", {rope}, 100}}},
        {"/crowd/ropes/*/free_length_m",
         {{"8", {loose_rope}, 100}, {"4", {R"(/crowd/ropes=[{"from":{"x_m":24,"z_m":7},"free_length_m":8}])"}, 100}}},
        {"/crowd/step_rate_hz", {{"20"}}},
        {"/crowd/markers_per_cell", {{"49"}}},
        {"/crowd/marker_min_distance_m", {{"0.15"}}},
        {"/crowd/marker_epoch_s", {{"2", {"/crowd/markers=redrawn"}}, {"2"}}},
        {"/crowd/body_radius_m", {{"0.3", with_human_bodies}}},
        {"/crowd/evasion/radius_m", {{"0.6", {"/crowd/evasion/rule=flee"}}, {"1"}}},
        {"/crowd/evasion/prediction_s", {{"0", {"/crowd/evasion/rule=evasion"}}, {"2"}}},
        {"/crowd/navigation/rule",
         {{"straight", {R"(/crowd/groups/1/goal={"x_m":4,"z_m":12})", R"(/crowd/groups/2/goal={"x_m":4,"z_m":12})"}},
          {"straight"}}},
        {"/crowd/navigation/cell_m", {{"1"}}},
        {"/crowd/navigation/crowding", {{"3"}}},
        {"/crowd/navigation/every_s", {{"0", {"/crowd/navigation/crowding=3"}}, {"0"}}},
        {"/crowd/navigation/sight_m", {{"1"}}},
        {"/crowd/navigation/enters_up_to_m", {{"0.1"}}},
        {"/crowd/navigation/safe_above_m", {{"0.4"}}},
        {"/crowd/perception_radius_m", {{"1.2"}}},
        {"/crowd/goal_radius_m", {{"23"}, {"23", {R"(/crowd/groups/0/goal={"to":"shelters"})"}}}},
        {"/crowd/ragdoll/condition", {{"local_speed", {"/crowd/groups/0/tau=0.9", "/crowd/ragdoll/speed_m_s=0.5"}}}},
        {"/crowd/ragdoll/tau_min",
         {{"1", {"/crowd/ragdoll/condition=local_speed", "/crowd/ragdoll/speed_m_s=0.5", "/crowd/groups/0/tau=0.9"}},
          {"1"}}},
        {"/crowd/ragdoll/speed_m_s",
         {{"0.5", {"/crowd/ragdoll/condition=local_speed", "/crowd/groups/0/tau=0.9"}}, {"1"}}},
        {"/crowd/ragdoll/depth_speed_m2_s", {{"0.1", {"/crowd/ragdoll/condition=depth_speed"}}, {"1"}}},
        {"/crowd/ragdoll/random_sign",
         {{"true", {"/crowd/ragdoll/condition=depth_speed", "/crowd/ragdoll/depth_speed_m2_s=0.1"}}, {"true"}}},
        {"/crowd/paths/rate_hz", {{"1"}}},
        {"/crowd/poses/rate_hz", {{"5"}}},
        {"/crowd/tau", {{"0.8"}}},
        {"/crowd/mass_kg", {{"80"}}},
        {"/crowd/desired_speed_m_s", {{"1"}}},
        {"/crowd/age", {{"80", {"/crowd/walking_in_water=bernardini"}}, {"10"}}},
        {"/crowd/height_m", {{"1.9"}}},
        {"/crowd/skill", {{"poor"}}},
        {"/crowd/bracing_arm", {{"0.02"}}},
        {"/crowd/people/*/age", {{"80", {"/crowd/walking_in_water=bernardini"}}, {"12"}}},
        {"/crowd/people/*/height_m", {{"1.9"}}},
        {"/crowd/people/*/mass_kg", {{"80"}}},
        {"/crowd/people/*/sex", {{"male"}, {"female"}}},
        {"/crowd/people/*/skill", {{"poor"}}},
        {"/crowd/people/*/bracing_arm", {{"0.02"}}},
        {"/crowd/people/*/tau_history/*/time_s", {{"1", {"/crowd/people=[{\"tau_history\":" + history + "}]"}}}},
        {"/crowd/people/*/tau_history/*/tau", {{"0.5", {"/crowd/people=[{\"tau_history\":" + history + "}]"}}}},
        {"/crowd/groups/*/columns", {{"2"}, {"4"}}},
        {"/crowd/groups/*/rows", {{"1"}, {"3"}}},
        {"/crowd/groups/*/count", {{"1"}, {"2"}}},
        {"/crowd/groups/*/start/x_m", {{"22"}}},
        {"/crowd/groups/*/start/z_m", {{"3"}}},
        {"/crowd/groups/*/start/pitch_x_m", {{"0.6"}}},
        {"/crowd/groups/*/start/pitch_z_m", {{"0.7"}}},
        {"/crowd/groups/*/start/jitter_m", {{"0.2"}}},
        {"/crowd/groups/*/leaves/rule", {{"weibull", {"/crowd/groups/1/leaves/scale_s=3"}}, {"never"}}},
        {"/crowd/groups/*/leaves/after_s", {{"2"}, {"2", leaves_by("table")}}},
        {"/crowd/groups/*/leaves/mean_s", {{"3", leaves_by("normal")}, {"3"}}},
        {"/crowd/groups/*/leaves/sd_s", {{"0.5", leaves_by("normal")}, {"1"}}},
        {"/crowd/groups/*/leaves/scale_s", {{"3", leaves_by("weibull")}, {"3"}}},
        {"/crowd/groups/*/leaves/shape", {{"1", leaves_by("weibull")}, {"1"}}},
        {"/crowd/groups/*/leaves/table/*/time_s", {{"3", leaves_by("table")}}},
        {"/crowd/groups/*/leaves/table/*/share", {{"0.3", leaves_by("table")}}},
        {"/crowd/groups/*/leaves/stay_share", {{"0.5"}, {"0.5", leaves_by("never")}}},
        {"/crowd/groups/*/leaves/upper_floor_share", {{"0.5"}}},
        {"/crowd/groups/*/goal/x_m", {{"10"}}},
        {"/crowd/groups/*/goal/z_m", {{"5"}}},
        {"/crowd/groups/*/desired_speed_m_s", {{"1"}}},
        {"/crowd/groups/*/tau", {{"0.8"}}},
        {"/crowd/groups/*/tau_history/*/time_s", {{"1", {"/crowd/groups/0/tau_history=" + history}}}},
        {"/crowd/groups/*/tau_history/*/tau", {{"0.5", {"/crowd/groups/0/tau_history=" + history}}}},
        {"/crowd/groups/*/age", {{"80", {"/crowd/walking_in_water=bernardini"}}, {"10"}}},
        {"/crowd/groups/*/height_m", {{"1.9"}}},
        {"/crowd/groups/*/skill", {{"poor"}}},
        {"/crowd/groups/*/bracing_arm", {{"0.02"}}},
        {"/crowd/groups/*/mass_kg", {{"80"}}},
        {"/crowd/groups/*/hand_in_hand", {{"along_x", {"/crowd/groups/0/start/pitch_x_m=0.7"}}}},
        {"/crowd/groups/*/hold",
         {{"arms", {"/crowd/groups/0/start/pitch_x_m=0.7", "/crowd/groups/0/hand_in_hand=along_x"}}, {"arms"}}},
        {"/crowd/groups/*/people/*/age", {{"80", {"/crowd/walking_in_water=bernardini"}}, {"12"}}},
        {"/crowd/groups/*/people/*/height_m", {{"1.9"}}},
        {"/crowd/groups/*/people/*/mass_kg", {{"80"}}},
        {"/crowd/groups/*/people/*/sex", {{"male"}, {"female"}}},
        {"/crowd/groups/*/people/*/skill", {{"poor"}}},
        {"/crowd/groups/*/people/*/bracing_arm", {{"0.02"}}},
        {"/crowd/groups/*/people/*/tau_history/*/time_s",
         {{"1", {"/crowd/groups/0/people=[{\"tau_history\":" + history + "}]"}}}},
        {"/crowd/groups/*/people/*/tau_history/*/tau",
         {{"0.5", {"/crowd/groups/0/people=[{\"tau_history\":" + history + "}]"}}}},
    };
    return all;
}

// Keys that no trial above can show, and why.
const std::map<std::string, std::string> untried{
    {"/crowd/people_csv", "takes the place of people as the file is read"},
    {"/crowd/groups/*/people_csv", "takes the place of people as the file is read"},
    {"/crowd/groups/*/name", "a label"},
    {"/crowd/groups/*/start/from", "the residents belong to one group: test_residents.cpp"},
};

const MadeUpWater& water_of_base(const Base& base) {
    static std::map<double, MadeUpWater> made;
    const auto found = made.find(base.depth);
    if (found != made.end()) return found->second;
    return made[base.depth] = uniform_water(0, 40, 6, 14, base.depth, 0.4, -base.speed, 0);
}

// All that a key can change: where people are and how they are, and how often it is written.
std::vector<double> state_after(const Base& base, const Scene& scene, int steps) {
    CrowdWorld crowd = make_crowd(scene);
    const MadeUpWater& water = water_of_base(base);
    const int dry = base.is_site ? 10 : 0;  // routes on a site change with the water
    std::vector<double> state;
    for (int k = 0; k < steps; ++k) {
        step(crowd, k < dry ? WaterView{} : water.view());
        for (const Ragdoll& one : crowd.ragdolls) {
            state.push_back(one.id);
            state.insert(state.end(), one.rate.begin(), one.rate.end());
        }
        for (std::size_t id = 0; id < crowd.agents.size(); ++id) {
            const Vector2d& p = crowd.agents.position[id];
            state.insert(state.end(), {p.x(), p.y(), static_cast<double>(crowd.agents.outcome[id])});
            const People& those = crowd.agents.people;
            if (those.by_body[id] == 0) continue;
            state.insert(state.end(), {static_cast<double>(those.condition[id].state), those.condition[id].air});
            if (those.wear.empty()) continue;
            const Wear& wear = those.wear[id];
            state.insert(state.end(), {wear.legs, wear.hands, wear.thigh, wear.chill, wear.swum});
        }
        for (const Link& link : crowd.links) state.push_back(link.pull);
        state.push_back(static_cast<double>(crowd.poses.size()));
    }
    state.push_back(static_cast<double>(steps_per_path_frame(scene)));
    return state;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) {
        return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
    });
}

LoadedScene loaded(const Base& base, const Assignments& assignments) {
    std::vector<SceneOverride> overrides;
    for (const std::string& assignment : assignments) overrides.push_back(parse_override(assignment));
    return load_scene_text(base.text, "scene.json", overrides);
}

const std::vector<double>& state_of(const Base& base, const Assignments& assignments, int steps) {
    static std::map<std::string, std::vector<double>> known;
    std::string name = base.text + std::to_string(base.depth) + std::to_string(steps);
    for (const std::string& assignment : assignments) name += assignment;
    const auto found = known.find(name);
    if (found != known.end()) return found->second;
    return known[name] = state_after(base, loaded(base, assignments).scene, steps);
}

std::string other_value(const KeyNode& node) {
    const Key& key = node.key;
    if (key.kind == KeyKind::choice) {
        const auto* preset = std::get_if<std::string>(&node.preset);
        return preset && *preset == key.choices[0] ? key.choices[1] : key.choices[0];
    }
    if (key.kind == KeyKind::flag) {
        const bool* const preset = std::get_if<bool>(&node.preset);
        return preset && *preset ? "false" : "true";
    }
    return std::to_string(std::max(key.range.lo, 0.0) * 0.8 + std::min(key.range.hi, 100.0) * 0.2);
}

enum class Shown { nothing, idle, effect };

// What one trial shows of a key at a pointer.
Shown show(const Base& base, const std::string& pointer, const std::string& value, const Trial& trial) {
    Assignments assignments = trial.beside;
    assignments.push_back(pointer + "=" + value);
    LoadedScene scene;
    bool same = false;
    try {
        const std::vector<double>& before = state_of(base, trial.beside, trial.steps);
        scene = loaded(base, assignments);
        same = same_bits(before, state_after(base, scene.scene, trial.steps));
    } catch (const ConfigurationError& error) {
        const std::string text = error.what();
        const bool is_named = text.find(": " + pointer + ": ") != std::string::npos;
        const bool says_so = text.find("has no effect, as it acts only") != std::string::npos ||
                             (is_named && text.find("out of range") == std::string::npos);
        return says_so ? Shown::idle : Shown::nothing;
    }
    const bool is_idle = std::any_of(scene.warnings.begin(), scene.warnings.end(), [&](const std::string& warning) {
        const std::string keys = warning.substr(0, warning.find(": no effect")) + ",";
        return keys.find(pointer + ",") != std::string::npos || keys.find(pointer + " (") != std::string::npos;
    });
    if (is_idle) CHECK(same);
    return is_idle ? Shown::idle : same ? Shown::nothing : Shown::effect;
}

// The pointers of a pattern: the first element of each list, and each group.
std::vector<std::string> pointers_of(std::string pattern, bool is_site) {
    std::vector<std::string> pointers;
    const std::string groups = "/crowd/groups/";
    const bool of_group = pattern.starts_with(groups);
    const std::string rest = of_group ? pattern.substr(groups.size() + 1) : pattern;
    std::string below;
    for (const char c : rest) below += c == '*' ? '0' : c;
    if (!of_group) return {below};
    for (int g = 0; g < (is_site ? 3 : 2); ++g) pointers.push_back(groups + std::to_string(g) + below);
    return pointers;
}

void collect(const KeyNode& node, const std::string& pattern,
             std::vector<std::pair<std::string, const KeyNode*>>& leaves) {
    for (const KeyNode& inner : node.inside) {
        const std::string below = pattern + "/" + std::string(inner.key.name);
        if (inner.key.kind == KeyKind::object || inner.key.kind == KeyKind::list) {
            collect(inner, inner.key.kind == KeyKind::list ? below + "/*" : below, leaves);
        } else {
            leaves.emplace_back(below, &inner);
        }
    }
}

TEST_CASE("Each key of the crowd has an effect on a channel and on a site, or is declared to have none") {
    std::vector<std::pair<std::string, const KeyNode*>> leaves;
    collect(*scene_keys().find("crowd"), "/crowd", leaves);
    CHECK(leaves.size() > 90);
    for (const Base& base : bases()) CHECK(loaded(base, {}).warnings.empty());
    std::set<std::string> patterns;
    for (const auto& [pattern, node] : leaves) {
        patterns.insert(pattern);
        if (untried.contains(pattern)) continue;
        const auto found = trials().find(pattern);
        const std::vector<Trial> of_key = found == trials().end() ? std::vector<Trial>{{}} : found->second;
        for (const bool is_site : {false, true}) {
            bool has_effect = false, always_idle = true;
            for (const Base& base : bases()) {
                if (base.is_site != is_site || has_effect) continue;
                for (const std::string& pointer : pointers_of(pattern, is_site)) {
                    for (const Trial& trial : of_key) {
                        INFO(pointer << (is_site ? " on a site" : " on a channel"));
                        const std::string value = trial.value.empty() ? other_value(*node) : trial.value;
                        const Shown shown = show(base, pointer, value, trial);
                        has_effect = has_effect || shown == Shown::effect;
                        always_idle = always_idle && shown == Shown::idle;
                    }
                    if (has_effect) break;
                }
            }
            INFO(pattern << (is_site ? " on a site" : " on a channel"));
            CHECK((has_effect || always_idle));
        }
    }
    for (const auto& [pattern, trial] : trials()) CHECK(patterns.contains(pattern));
    for (const auto& [pattern, reason] : untried) CHECK(patterns.contains(pattern));
}

TEST_CASE("Keys of contacts act where somebody has a tau, and are told of where people answer by their bodies") {
    const std::vector<std::pair<std::string, std::string>> keys{{"/coupling/contact_rule", "sum"},
                                                                {"/coupling/rule", "continuous"},
                                                                {"/coupling/agent_radius_m", "0.7"},
                                                                {"/coupling/particle_radius_m", "0.1"}};
    const Trial ragdolls{"", {"/crowd/ragdoll/condition=depth_speed", "/crowd/ragdoll/depth_speed_m2_s=0.1"}};
    for (const auto& [pointer, value] : keys) {
        for (const Base& base : bases()) {
            INFO(pointer << " " << base.text);
            const bool by_body = base.text.find("measured") != std::string::npos;
            CHECK(show(base, pointer, value, {}) == (by_body ? Shown::idle : Shown::effect));
            const bool in_contact = pointer != "/coupling/rule";
            if (by_body && !base.is_site)
                CHECK(show(base, pointer, value, ragdolls) == (in_contact ? Shown::effect : Shown::idle));
        }
    }
}

TEST_CASE("Keys of particles are told of on a site of shallow water, whose cells are columns") {
    const Base& base = bases()[3];
    const auto told = [&](const std::string& model, const std::string& assignment) {
        const std::vector<std::string> warnings = loaded(base, {"/fluid/model=" + model, assignment}).warnings;
        return std::any_of(warnings.begin(), warnings.end(), [&](const std::string& warning) {
            return warning.find(assignment.substr(0, assignment.find('='))) != std::string::npos;
        });
    };
    for (const std::string assignment : {"/fluid/particle_spacing_m=0.3", "/fluid/max_particles=200000"}) {
        CHECK(told("shallow_water", assignment));
        CHECK_FALSE(told("dfsph", assignment));
    }
}

}  // namespace wade::crowd::key_effects_test
