// Checks start positions, goals and markers of the agents, and that events name what exists.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <set>
#include <vector>

#include "configs/checks/scene_checks.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/choices.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fields/residents.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/near_positions.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/person_size.hpp"
#include "configs/scene/site.hpp"
#include "configs/scene/time_lines.hpp"
#include "configs/scene/world.hpp"

namespace wade {

namespace {

std::string words(double x, double z) {
    return "(x " + short_number(x) + " m, z " + short_number(z) + " m)";
}

void check_place(double x, double z, const Scene& scene, const std::string& who, const std::string& source,
                 const std::string& pointer) {
    const Interval world_x{0, scene.world->length}, world_z{0, scene.world->width};
    if (!world_x.contains(x) || !world_z.contains(z)) {
        refuse(source, pointer,
               who + " at " + words(x, z) + " is outside the world; allowed: x 0 to " + short_number(world_x.hi) +
                   " m, z 0 to " + short_number(world_z.hi) + " m.");
    }
    for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
        const Obstacle& obstacle = scene.obstacles[i];
        if (!obstacle.x.contains(x) || !obstacle.z.contains(z)) continue;
        refuse(source, pointer,
               who + " at " + words(x, z) + " is inside /obstacles/" + std::to_string(i) +
                   "; allowed: anywhere but x " + short_number(obstacle.x.lo) + " to " + short_number(obstacle.x.hi) +
                   " m with z " + short_number(obstacle.z.lo) + " to " + short_number(obstacle.z.hi) + " m.");
    }
}

// Starts that are drawn at random keep their distance by the draw.
void check_distances(const std::vector<StartPlace>& places, const Crowd& crowd, const std::string& source) {
    NearPositions starts;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const StartPlace& place = places[i];
        if (crowd.groups[place.group].start_jitter > 0) continue;
        if (const auto other = starts.near(place.x, place.z)) {
            refuse(source, "/crowd/groups/" + std::to_string(place.group) + "/start",
                   "agents " + std::to_string(*other) + " and " + std::to_string(i) + " start at one place, " +
                       words(place.x, place.z) + "; allowed: a distance >= " + short_number(smallest_start_distance) +
                       " m.");
        }
        starts.add(place.x, place.z, i);
    }
}

// Returns the goal's x wrapped into one period of the world; unchanged if the world is not periodic.
double goal_in_world(const Scene& scene, double x) {
    const double period = scene.world->period();
    return period > 0 ? x - period * std::floor(x / period) : x;
}

void check_count(const AgentGroup& group, const std::string& source, const std::string& pointer) {
    const std::int64_t places = std::int64_t{group.columns} * group.rows;
    if (group.count <= places || group.starts == StartRule::houses) return;
    refuse(source, pointer,
           std::to_string(group.count) + " agents do not fit on the start grid of " + std::to_string(group.columns) +
               " columns and " + std::to_string(group.rows) + " rows; allowed: <= " + std::to_string(places) + ".");
}

void check_groups(const Scene& scene, const std::string& source, Problems& problems) {
    std::set<std::string> names;
    for (std::size_t g = 0; g < scene.crowd->groups.size(); ++g) {
        const AgentGroup& group = scene.crowd->groups[g];
        const std::string pointer = "/crowd/groups/" + std::to_string(g);
        problems.attempt([&] {
            if (names.insert(group.name).second) return;
            refuse(source, pointer + "/name",
                   "\"" + group.name + "\" is the name of an earlier group; allowed: any other.");
        });
        problems.attempt([&] { check_count(group, source, pointer + "/count"); });
        if (group.goals == GoalRule::shelters) continue;
        problems.attempt([&] {
            check_place(goal_in_world(scene, group.goal_x), group.goal_z, scene,
                        "the goal of group \"" + group.name + "\"", source, pointer + "/goal");
        });
    }
}

// Limits the number of agents, so that the start positions fit into memory before they are checked one by one.
void check_number(const Crowd& crowd, const std::string& source) {
    constexpr std::int64_t most = 10'000'000;
    std::int64_t agents = 0;
    for (const AgentGroup& group : crowd.groups) agents += group.count;
    if (agents <= most) return;
    refuse(source, "/crowd/groups",
           std::to_string(agents) + " agents in all are too many; allowed: <= " + std::to_string(most) + ".");
}

// Notes the first agent of each group that cannot start at its position.
void check_starts(const std::vector<StartPlace>& places, const Scene& scene, const std::string& source,
                  Problems& problems) {
    std::set<std::size_t> told;
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (told.contains(places[i].group)) continue;
        const bool right = problems.attempt([&] {
            check_place(places[i].x, places[i].z, scene, "agent " + std::to_string(i), source,
                        "/crowd/groups/" + std::to_string(places[i].group) + "/start");
        });
        if (!right) told.insert(places[i].group);
    }
}

// Redrawn markers stand in side x side sub-cells of a cell of 2 x 2 m, one in each.
void check_sub_cells(const Crowd& crowd, const std::string& source) {
    constexpr double cell = 2;
    const double side = std::round(std::sqrt(crowd.markers_per_cell));
    if (side * side != crowd.markers_per_cell) {
        refuse(source, "/crowd/markers_per_cell",
               std::to_string(crowd.markers_per_cell) +
                   " markers cannot be redrawn, one in each of n x n sub-cells; allowed: a square number, 16, 25, 36, "
                   "49, 64, 81 and so on, or markers \"fixed\".");
    }
    if (crowd.marker_min_distance <= cell / side) return;
    refuse(source, "/crowd/marker_min_distance_m",
           short_number(crowd.marker_min_distance) + " m is too large for redrawn markers in sub-cells of " +
               short_number(cell / side) + " m; allowed: <= " + short_number(cell / side) + " m.");
}

// Checks that the markers fit: per cell of 4 m2, n discs of radius r/2 without overlap cover the fraction
// n pi (r/2)^2 / 4. Discs placed one by one at random jam at 0.547 (random sequential adsorption in the plane, Feder
// 1980); the limit of 0.5 lets the generator finish.
void check_markers(const Crowd& crowd, const std::string& source) {
    if (crowd.markers == MarkerRule::redrawn) {
        check_sub_cells(crowd, source);
        return;
    }
    constexpr double cell_area = 4, largest_share = 0.5;
    const double largest = 2 * std::sqrt(largest_share * cell_area / (std::numbers::pi * crowd.markers_per_cell));
    if (crowd.marker_min_distance <= largest) return;
    refuse(source, "/crowd/marker_min_distance_m",
           short_number(crowd.marker_min_distance) + " m is too large for " + std::to_string(crowd.markers_per_cell) +
               " markers to fit at random into a cell of 2 x 2 m; allowed: <= " + short_number(largest) + " m.");
}

// The cells of the ground are 2 m wide, and an agent looks into those beside its own: in a ring of three they differ.
void check_ends(const Scene& scene, const std::vector<StartPlace>& places, const std::string& source) {
    if (scene.world->ends == Ends::open) return;
    constexpr double cell = 2;
    const double length = scene.world->length;
    if (length < 3 * cell || std::fmod(length, cell) != 0) {
        refuse(source, "/world/length_m",
               short_number(length) +
                   " m cannot be the length of a world with periodic ends; allowed: 6 m, 8 m, 10 m "
                   "and so on in steps of 2 m.");
    }
    for (const StartPlace& place : places) {
        if (place.x < length) continue;
        refuse(source, "/crowd/groups/" + std::to_string(place.group) + "/start",
               "an agent starts at x " + short_number(place.x) +
                   " m, which in a world with periodic ends is x 0 m; allowed: x < " + short_number(length) + " m.");
    }
    const Channel& channel = scene.channel;
    const bool dry = channel.flow == Flow::closed && channel.water_blocks.empty();
    const bool ring = (channel.flow == Flow::recirculating || channel.flow == Flow::periodic) && channel.x.lo == 0 &&
                      channel.x.hi == length;
    if (dry || ring) return;
    refuse(source, "/world/ends",
           "\"periodic\" does not go with water that ends; allowed: \"open\", or a channel from x 0 to " +
               short_number(length) +
               " m with flow \"recirculating\" or \"periodic\", or a dry one: flow \"closed\" without water_blocks.");
}

// What is wrong with the size of a person of a table, in the group that it belongs to.
std::optional<SizeFault> fault_of_person(const AgentGroup& group, const PersonRow& row) {
    const Spread& ages = group.body.age;
    const Interval age = row.age ? Interval{*row.age, *row.age} : Interval{ages.lo, ages.hi};
    const bool of_group = are_children(ages) == (age.hi < adult_age);
    std::optional<Spread> height, mass;
    if (row.height || (of_group && group.body.height)) height = row.height ? Spread(*row.height) : group.body.height;
    if (row.mass || (of_group && group.mass)) mass = row.mass ? Spread(*row.mass) : group.mass;
    const bool of_adults = !row.age && !row.height && !row.mass && !are_children(ages);
    return fault_of_size(of_adults ? Interval{std::max(age.lo, adult_age), age.hi} : age, height, mass);
}

void check_size(const std::optional<SizeFault>& fault, const std::string& source, const std::string& pointer) {
    if (fault) refuse(source, pointer + (fault->is_mass ? "/mass_kg" : "/height_m"), fault->sentence);
}

void check_table(const std::vector<PersonRow>& people, const AgentGroup& group, const std::string& source,
                 const std::string& pointer, Problems& problems) {
    for (std::size_t i = 0; i < people.size(); ++i) {
        problems.attempt(
            [&] { check_size(fault_of_person(group, people[i]), source, pointer + "/people/" + std::to_string(i)); });
    }
}

// Returns the residents of the site's table that belong to a group.
void check_sizes_of_residents(const Scene& scene, std::size_t g, const std::string& source, Problems& problems) {
    for_each_resident(scene, g, [&](const Resident& one) {
        const auto fault = fault_of_person(scene.crowd->groups[g], one.person);
        if (!fault) return;
        const std::string file = scene.site_keys->residents.value_or("");
        problems.note(source + ": /site/residents_csv: " + file + ": line " + std::to_string(one.line) + ": " +
                      (fault->is_mass ? "mass" : "height") + ": " + fault->sentence);
    });
}

// Mass and height are drawn apart, so that the heaviest may be the smallest.
void check_bodies(const Scene& scene, std::size_t g, const std::string& source, Problems& problems) {
    const Crowd& crowd = scene.crowd;
    const AgentGroup& group = crowd.groups[g];
    const std::string pointer = "/crowd/groups/" + std::to_string(g);
    if (crowd.response == ResponseKind::measured)
        problems.attempt([&] { check_size(fault_of_person(group, {}), source, pointer); });
    check_sizes_of_residents(scene, g, source, problems);
    if (group.people.empty()) {
        check_table(crowd.people, group, source, "/crowd", problems);
    } else {
        check_table(group.people, group, source, pointer, problems);
    }
}

// Checks that the times of tau histories do not decrease, and that people with the body response have no history.
void check_tau_histories(const Crowd& crowd, std::size_t g, const std::string& source, Problems& problems) {
    const AgentGroup& group = crowd.groups[g];
    const std::string pointer = "/crowd/groups/" + std::to_string(g);
    problems.attempt([&] { check_times(times_of(group.tau_history), source, pointer + "/tau_history"); });
    const bool of_its_own = !group.people.empty();
    const std::vector<PersonRow>& people = of_its_own ? group.people : crowd.people;
    for (std::size_t i = 0; i < people.size(); ++i) {
        const std::string list = (of_its_own ? pointer : "/crowd") + "/people/" + std::to_string(i) + "/tau_history";
        problems.attempt([&] { check_times(times_of(people[i].tau_history), source, list); });
        problems.attempt([&] {
            if (people[i].tau_history.empty() || group.tau || crowd.response != ResponseKind::measured) return;
            refuse(source, list,
                   "a person of group \"" + group.name +
                       "\" answers the water by its body and has no tau; allowed: none, a tau of this group, or the "
                       "response \"paper\".");
        });
    }
}

// Checks that people of a group with hand_in_hand can hold one another: they respond by their bodies, not by tau, and
// neighbours start within reach.
void check_hands(const Scene& scene, const AgentGroup& group, const std::string& source, const std::string& pointer) {
    if (group.hand_in_hand == HandInHand::none) return;
    const std::string key = pointer + "/hand_in_hand", hands = name_of(group.hand_in_hand);
    if (scene.crowd->response != ResponseKind::measured || group.tau) {
        refuse(source, key,
               hands +
                   ": people that answer the water by tau hold no others; allowed: \"none\", or the response "
                   "\"measured\" and no tau of the group.");
    }
    const bool along_x = group.hand_in_hand == HandInHand::along_x;
    const double pitch = along_x ? group.pitch_x : group.pitch_z, reach = 0.8;
    if (pitch + 2 * group.start_jitter <= reach) return;
    refuse(source, key,
           hands + ": neighbours start up to " + short_number(pitch + 2 * group.start_jitter) + " m apart (/start/" +
               (along_x ? "pitch_x_m" : "pitch_z_m") +
               " and twice /start/jitter_m); allowed: <= 0.8 m, as far as hands reach.");
}

void check_rescuers(const Scene& scene, const AgentGroup& group, const std::string& source,
                    const std::string& pointer) {
    if (!group.rescuer) return;
    if (scene.crowd->response != ResponseKind::measured || group.tau) {
        refuse(source, pointer + "/rescuer",
               "true: people that answer the water by tau hold no others; allowed: false, or the response \"measured\" "
               "and "
               "no tau of the group.");
    }
    if (group.hand_in_hand == HandInHand::none) return;
    refuse(source, pointer + "/rescuer",
           "true: a line takes both hands, and the group walks with hand_in_hand " + name_of(group.hand_in_hand) +
               "; allowed: false, or hand_in_hand \"none\".");
}

void check_rope(const Scene& scene, const Rope& rope, const std::string& source, const std::string& pointer) {
    if (scene.crowd->response != ResponseKind::measured) {
        refuse(source, pointer,
               "people that answer the water by tau hold no rope; allowed: no ropes, or the response \"measured\".");
    }
    if (rope.to_x.has_value() != rope.to_z.has_value()) {
        refuse(source, pointer + "/to", "an end has x_m and z_m; allowed: both, or neither.");
    }
    if (rope.to_x.has_value() == rope.free_length.has_value()) {
        refuse(source, pointer,
               "a rope has either a second end, to, or a free one, free_length_m; allowed: one of both.");
    }
    const auto check_end = [&](const std::string& end, double x, double z) {
        if (x <= scene.world->length && z <= scene.world->width) return;
        refuse(source, pointer + "/" + end,
               words(x, z) + " is outside the world; allowed: " + words(scene.world->length, scene.world->width) +
                   " or less.");
    };
    check_end("from", rope.from_x, rope.from_z);
    if (!rope.to_x) return;
    check_end("to", *rope.to_x, *rope.to_z);
    if (*rope.to_x != rope.from_x || *rope.to_z != rope.from_z) return;
    refuse(source, pointer + "/to", "both ends are at one place; allowed: another, or free_length_m 0 for a post.");
}

// People feel the water within 1.5 spacings, and the crowd sorts it within 2 m of each.
void check_measured(const Scene& scene, const std::string& source, Problems& problems) {
    if (scene.crowd->response != ResponseKind::measured) return;
    constexpr double widest = 2 / 1.5;
    problems.attempt([&] {
        if (scene.fluid->particle_spacing <= widest) return;
        refuse(source, "/fluid/particle_spacing_m",
               short_number(scene.fluid->particle_spacing) +
                   " m: with the response measured people feel the water within "
                   "1.5 spacings, and 2 m is the most; allowed: <= 1.3333 m.");
    });
}

void check_ragdoll(const Scene& scene, const std::string& source) {
    const bool v_f_is_set = scene.channel->flow == Flow::emitter || scene.channel->flow == Flow::recirculating;
    if (scene.crowd->ragdoll.condition != RagdollCondition::paper || v_f_is_set) return;
    refuse(
        source, "/crowd/ragdoll/condition",
        "\"paper\" asks for v_F, and nothing sets the speed of a " + name_of(scene.channel->flow) +
            " channel; allowed: \"off\", \"local_speed\", \"depth_speed\", or flow \"emitter\" or \"recirculating\".");
}

void check_sampling(const Coupling& coupling, const std::string& source) {
    if (coupling.sampling_rate == 0 || coupling.rule == CouplingRule::continuous) return;
    refuse(source, "/coupling/sampling_rate_hz",
           short_number(coupling.sampling_rate) +
               " 1/s: the rule \"per_frame\" takes the water once a step; allowed: 0, or any rate with the rule "
               "\"continuous\".");
}

}  // namespace

std::vector<StartPlace> start_places(const Crowd& crowd) {
    std::vector<StartPlace> places;
    for (std::size_t g = 0; g < crowd.groups.size(); ++g) {
        const AgentGroup& group = crowd.groups[g];
        if (group.starts == StartRule::houses) continue;
        for (int k = 0; k < group.count; ++k) {
            const int column = k % group.columns, row = k / group.columns;
            places.push_back({group.start_x + column * group.pitch_x, group.start_z + row * group.pitch_z, g});
        }
    }
    return places;
}

void check_crowd(const Scene& scene, const std::string& source, Problems& problems) {
    check_groups(scene, source, problems);
    if (!problems.attempt([&] { check_number(scene.crowd, source); })) return;
    const std::vector<StartPlace> places = start_places(scene.crowd);
    check_starts(places, scene, source, problems);
    problems.attempt([&] { check_distances(places, scene.crowd, source); });
    problems.attempt([&] { check_ends(scene, places, source); });
    problems.attempt([&] { check_markers(scene.crowd, source); });
    problems.attempt([&] { check_ragdoll(scene, source); });
    check_measured(scene, source, problems);
    for (std::size_t g = 0; g < scene.crowd->groups.size(); ++g) {
        const std::string pointer = "/crowd/groups/" + std::to_string(g);
        check_bodies(scene, g, source, problems);
        check_tau_histories(scene.crowd, g, source, problems);
        problems.attempt([&] { check_hands(scene, scene.crowd->groups[g], source, pointer); });
        problems.attempt([&] { check_rescuers(scene, scene.crowd->groups[g], source, pointer); });
    }
    for (std::size_t i = 0; i < scene.crowd->ropes.size(); ++i) {
        problems.attempt(
            [&] { check_rope(scene, scene.crowd->ropes[i], source, "/crowd/ropes/" + std::to_string(i)); });
    }
    problems.attempt([&] { check_sampling(scene.coupling, source); });
    check_events(scene, source, problems);
    check_residents(scene, source, problems);
}

}  // namespace wade
