// Whether events name people that there are, and whether those of a site have houses, shelters and room.

#include <algorithm>
#include <cstdint>
#include <set>
#include <sstream>

#include "configs/checks/scene_checks.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/choices.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fields/residents.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"

namespace wade {

namespace {

std::string at(double x, double z) {
    return "(x " + short_number(x) + " m, z " + short_number(z) + " m)";
}

void check_event(const Scene& scene, std::size_t i, std::size_t agents, const std::string& source) {
    const TauEvent& event = scene.events[i];
    const std::string pointer = "/events/" + std::to_string(i);
    if (event.agent && event.group) {
        refuse(source, pointer, "an event names an agent or a group, not both.");
    }
    if (event.agent && static_cast<std::size_t>(*event.agent) >= agents) {
        refuse(source, pointer + "/agent",
               "there is no agent " + std::to_string(*event.agent) + "; allowed: " +
                   (agents == 0 ? "none, as the scene has no agents." : "0 to " + std::to_string(agents - 1) + "."));
    }
    if (!event.group) return;
    std::string known;
    for (const AgentGroup& group : scene.crowd->groups) {
        if (group.name == *event.group) return;
        known += (known.empty() ? "\"" : ", \"") + group.name + "\"";
    }
    refuse(source, pointer + "/group",
           "there is no group \"" + *event.group +
               "\"; allowed: " + (known.empty() ? "none, as the scene has no groups." : known + "."));
}

void check_goal_outside(const Scene& scene, const AgentGroup& group, const std::string& source,
                        const std::string& pointer) {
    if (group.goals == GoalRule::shelters) return;
    for (const House& house : scene.site->houses) {
        if (!contains(house.polygon, {group.goal_x, group.goal_z})) continue;
        refuse(source, pointer + "/goal",
               "the goal of group \"" + group.name + "\" at " + at(group.goal_x, group.goal_z) + " is in the house " +
                   house.label + "; allowed: outside, or to \"shelters\" with a shelter there.");
    }
}

void check_needs_of_site(const Scene& scene, const AgentGroup& group, const std::string& source,
                         const std::string& pointer) {
    const bool in_houses = group.starts == StartRule::houses, to_shelters = group.goals == GoalRule::shelters;
    if (!scene.site && in_houses)
        refuse(source, pointer + "/start/from", "\"houses\": the scene has no site; allowed: \"grid\", or /site.");
    if (!scene.site && to_shelters)
        refuse(source, pointer + "/goal/to", "\"shelters\": the scene has no site; allowed: \"point\", or /site.");
    if (to_shelters && scene.site->shelters.empty() && !scene.crowd->navigation.safe_above)
        refuse(source, pointer + "/goal/to",
               "\"shelters\": the site has none; allowed: /site/shelters, /crowd/navigation/safe_above_m, or "
               "\"point\".");
    if (in_houses && (group.hand_in_hand != HandInHand::none || group.rescuer || group.start_jitter > 0))
        refuse(source, pointer + "/start/from",
               "\"houses\" goes with no hand_in_hand, rescuer or jitter_m; allowed: \"grid\" for such a group.");
}

void check_leaving(const AgentGroup& group, const std::string& source, const std::string& pointer) {
    const std::vector<LeavingPoint>& table = group.leaving.table;
    if (group.leaving.rule == LeavingRule::table && table.empty())
        refuse(source, pointer + "/leaves/table", "there are no points; allowed: at least one, or another rule.");
    for (std::size_t k = 1; k < table.size(); ++k) {
        if (table[k].time >= table[k - 1].time && table[k].share >= table[k - 1].share) continue;
        refuse(source, pointer + "/leaves/table/" + std::to_string(k),
               "time " + short_number(table[k].time) + " s, share " + short_number(table[k].share) +
                   " go back; allowed: at least " + short_number(table[k - 1].time) + " s and " +
                   short_number(table[k - 1].share) + ".");
    }
}

// Throws at the first resident of the table outside the world or in a group that does not start in houses.
void check_table_of_residents(const Scene& scene, const std::string& source) {
    std::set<std::string> groups;
    for (const AgentGroup& group : scene.crowd->groups) {
        if (group.starts == StartRule::houses) groups.insert(group.name);
    }
    std::string known;
    for (const std::string& name : groups) known += (known.empty() ? "\"" : ", \"") + name + "\"";
    std::size_t number = 0;
    for (const Resident& one : *scene.site->residents) {
        const std::string who = "person " + (one.id.empty() ? std::to_string(number) : "\"" + one.id + "\"");
        ++number;
        if (!one.group.empty() && groups.count(one.group) == 0) {
            refuse(source, "/site/residents_csv",
                   who + " is of group \"" + one.group + "\", which does not start in houses; allowed: " +
                       (known.empty() ? "a group with start/from \"houses\"." : known + "."));
        }
        if (one.x >= 0 && one.x <= scene.world->length && one.z >= 0 && one.z <= scene.world->width) continue;
        std::ostringstream place;
        place.precision(10);
        place << who << " at (" << one.x + scene.site->origin_x << ", " << one.z + scene.site->origin_z
              << ") of the site's system is outside the world; allowed: " << scene.site->origin_x << " to "
              << scene.site->origin_x + scene.world->length << ", " << scene.site->origin_z << " to "
              << scene.site->origin_z + scene.world->width << ". Is it in another system?";
        refuse(source, "/site/residents_csv", place.str());
    }
}

// Requires a group for the residents of the site.
void check_lodgers(const Scene& scene, const std::string& source, Problems& problems) {
    const Site& site = *scene.site;
    std::int64_t in_houses = 0;
    for (const House& house : site.houses) in_houses += house.residents;
    const bool has_group = first_group_in_houses(scene.crowd) < scene.crowd->groups.size();
    if (!has_group && ((in_houses > 0 && !scene.crowd->groups.empty()) || site.residents)) {
        problems.attempt([&] {
            refuse(source, "/crowd/groups",
                   "the site has residents, and no group starts in houses; allowed: a group with start/from "
                   "\"houses\", or no residents.");
        });
        return;
    }
    for (std::size_t g = 0; g < scene.crowd->groups.size(); ++g) {
        const AgentGroup& group = scene.crowd->groups[g];
        if (group.starts != StartRule::houses || group.count > 0) continue;
        problems.attempt([&] {
            refuse(source, "/crowd/groups/" + std::to_string(g) + "/start/from",
                   "no people live in houses of group \"" + group.name +
                       "\"; allowed: residents of /site/houses, which are the first such group's, or of its "
                       "residents_csv.");
        });
    }
    if (site.residents) {
        problems.attempt([&] { check_table_of_residents(scene, source); });
    }
}

// Whether the water that people meet changes with time: not given streams, still water and dry ground.
bool water_changes(const Scene& scene) {
    if (scene.coupling->two_way) return true;
    if (scene.fluid->model == ModelKind::kinematic) return scene.channel->initial_river == InitialRiver::dry;
    if (!scene.site) return scene.channel->flow != Flow::closed || !scene.channel->water_blocks.empty();
    const Site& site = *scene.site;
    return !site.sources.empty() || !site.rain.empty() || !site.outlets.empty() || !site.barriers.empty() ||
           site.water_depth || site.water.size() > 1;
}

}  // namespace

std::vector<std::string> rate_warnings(const Scene& scene) {
    constexpr double least = 2;  // 1/s
    std::vector<std::string> warnings;
    const auto measured = [](const AgentGroup& group) { return !group.tau; };
    const auto& groups = scene.crowd->groups;
    if (scene.crowd->response != ResponseKind::measured || std::none_of(groups.begin(), groups.end(), measured) ||
        !water_changes(scene))
        return warnings;
    const auto warn_below = [&](double rate, const std::string& key, const std::string& what) {
        if (rate >= least) return;
        warnings.push_back(key + ": " + short_number(rate) + " " + what +
                           " a second: outcomes in water that changes depend on the rate below " + short_number(least) +
                           " 1/s. Remedy: " + key + " " + short_number(least) + " or more.");
    };
    warn_below(scene.frame_rate, "/frame_rate_hz", "frames of the water");
    if (scene.crowd->step_rate != scene.frame_rate)
        warn_below(scene.crowd->step_rate, "/crowd/step_rate_hz", "steps of the crowd");
    return warnings;
}

void check_events(const Scene& scene, const std::string& source, Problems& problems) {
    std::size_t agents = 0;
    for (const AgentGroup& group : scene.crowd->groups) agents += static_cast<std::size_t>(group.count);
    for (std::size_t i = 0; i < scene.events.size(); ++i) {
        problems.attempt([&] { check_event(scene, i, agents, source); });
    }
}

void check_residents(const Scene& scene, const std::string& source, Problems& problems) {
    for (std::size_t g = 0; g < scene.crowd->groups.size(); ++g) {
        const AgentGroup& group = scene.crowd->groups[g];
        const std::string pointer = "/crowd/groups/" + std::to_string(g);
        problems.attempt([&] { check_needs_of_site(scene, group, source, pointer); });
        problems.attempt([&] { check_leaving(group, source, pointer); });
        if (scene.site) problems.attempt([&] { check_goal_outside(scene, group, source, pointer); });
    }
    if (scene.site) check_lodgers(scene, source, problems);
    problems.attempt([&] {
        if (scene.fluid->publish == Publish::all) return;
        if (scene.site && scene.fluid->model != ModelKind::shallow_water) {
            refuse(source, "/fluid/publish",
                   "\"near_agents\" is for columns of water, which /fluid/model \"" + name_of(scene.fluid->model) +
                       "\" has none of; allowed: \"all\".");
        }
        if (!scene.site || scene.coupling->agents_stream == AgentsStream::off) {
            refuse(source, "/fluid/publish",
                   "\"near_agents\" asks where they are, on a site; allowed: \"all\", or /site and "
                   "/coupling/agents_stream \"serial\" or \"parallel\".");
        }
    });
}

}  // namespace wade
