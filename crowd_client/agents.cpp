#include "crowd_client/agents.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/near_positions.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/markers/counter_random.hpp"
#include "crowd_client/markers/placed_boxes.hpp"
#include "crowd_client/markers/placed_houses.hpp"

namespace wade::crowd {
namespace {

// Random numbers of the agents, separate from the markers' numbers: a stream per agent, a counter per purpose.
// Start positions take the counters from `draw_start` on, two per trial.
enum Draw : std::uint64_t {
    draw_tau,
    draw_mass,
    draw_sex,
    draw_height,
    draw_age,
    draw_friction,
    draw_leaves,
    draw_stays,
    draw_goes_up,
    draw_drowns,
    draw_start = 16
};

double random_of(const Scene& scene, std::size_t id, std::uint64_t draw) {
    constexpr std::uint64_t agents_streams = std::uint64_t{1} << 40;
    return counter_uniform(scene.seed, agents_streams + id, draw);
}

// Mirrors a deviation past an edge at the edge, as often as needed, so that starts stay spread.
double folded_into(double v, double length) {
    const double there_and_back = std::fmod(std::abs(v), 2 * length);
    return there_and_back > length ? 2 * length - there_and_back : there_and_back;
}

// Obstacles and houses, which no start may lie in.
struct Solids {
    PlacedBoxes obstacles;
    PlacedHouses houses;
};

bool in_an_obstacle(const Solids& solids, const Vector2d& p) {
    return is_in_a_house(solids.houses, p) ||
           any_near(solids.obstacles, {p.x(), p.x()}, {p.y(), p.y()},
                    [&](const Obstacle& o) { return o.x.contains(p.x()) && o.z.contains(p.y()); });
}

// Returns a position of the start grid with the deviation of a trial.
Vector2d deviated(const Scene& scene, std::size_t id, const Vector2d& place, double jitter, std::uint64_t trial) {
    const double period = scene.world->period();
    const double u = random_of(scene, id, draw_start + 2 * trial);
    const double w = random_of(scene, id, draw_start + 2 * trial + 1);
    Vector2d start = place + jitter * Vector2d(2 * u - 1, 2 * w - 1);
    start.x() =
        period > 0 ? start.x() - period * std::floor(start.x() / period) : folded_into(start.x(), scene.world->length);
    if (period > 0 && start.x() >= period) start.x() = 0;
    start.y() = folded_into(start.y(), scene.world->width);
    return start;
}

// Returns the first trial outside obstacles and away from all starts in `taken`; the position itself if all fail.
// Throws ConfigurationError if that is taken, too.
Vector2d jittered(const Scene& scene, std::size_t id, const AgentGroup& group, std::size_t g, const Vector2d& place,
                  const Solids& solids, const NearPositions& taken) {
    constexpr std::uint64_t trials = 100;
    for (std::uint64_t trial = 0; trial < trials; ++trial) {
        const Vector2d start = deviated(scene, id, place, group.start_jitter, trial);
        if (!in_an_obstacle(solids, start) && !taken.near(start.x(), start.y())) return start;
    }
    if (!taken.near(place.x(), place.y())) return place;
    std::ostringstream message;
    message << "/crowd/groups/" << g << "/start/jitter_m: " << group.start_jitter << " m leaves agent " << id
            << " no start that is " << smallest_start_distance << " m away from the others; allowed: more, 0, or "
            << "fewer agents at (" << place.x() << ", " << place.y() << ")";
    throw ConfigurationError(message.str());
}

// Draws the random starts. Starts on the grid are taken first, as random starts keep away from them.
void draw_starts(const Scene& scene, Agents& agents) {
    const auto group_of = [&](std::size_t id) -> const AgentGroup& { return scene.crowd->groups[agents.group[id]]; };
    const auto is_drawn = [&](std::size_t id) { return group_of(id).start_jitter > 0; };
    const Solids solids{place_boxes(scene.obstacles), houses_of(scene)};
    NearPositions taken;
    for (std::size_t id = 0; id < agents.size(); ++id) {
        if (!is_drawn(id)) taken.add(agents.position[id].x(), agents.position[id].y(), id);
    }
    for (std::size_t id = 0; id < agents.size(); ++id) {
        if (!is_drawn(id)) continue;
        Vector2d& place = agents.position[id];
        place = jittered(scene, id, group_of(id), agents.group[id], place, solids, taken);
        taken.add(place.x(), place.y(), id);
    }
}

// Returns the table row of the `member`-th agent of a group; without a table, a row that sets nothing.
PersonRow person_of_table(const Crowd& crowd, const AgentGroup& group, int member, std::size_t id) {
    if (!group.people.empty()) return group.people[static_cast<std::size_t>(member) % group.people.size()];
    return crowd.people.empty() ? PersonRow{} : crowd.people[id % crowd.people.size()];
}

// Adds the agent's tau over time: from its table row, else `of_group`, that of its group.
void add_tau_line(Agents& agents, std::size_t id, const PersonRow& person, const TauLine& of_group) {
    TauLine line = of_group;
    if (!person.tau_history.empty()) line.points = std::make_shared<const std::vector<TauPoint>>(person.tau_history);
    if (!line.points) return;
    line.id = static_cast<std::uint32_t>(id);
    agents.tau[id] = line.points->front().tau;
    agents.tau_lines.push_back(std::move(line));
}

void check_start(const World& world, std::size_t group, int member, const Vector2d& p) {
    if (p.x() >= 0 && p.x() <= world.length && p.y() >= 0 && p.y() <= world.width) return;
    std::ostringstream message;
    message << "/crowd/groups/" << group << ": agent " << member << " of the group starts at (" << p.x() << ", "
            << p.y() << "), outside the world [0, " << world.length << "] x [0, " << world.width << "] m";
    throw ConfigurationError(message.str());
}

// Returns the middle of the nearest shelter in a straight line; the position itself if there is none.
Vector2d nearest_shelter(const Scene& scene, const Vector2d& place) {
    Vector2d nearest = place;
    double least = never;
    for (const SiteShelter& shelter : scene.site->shelters) {
        Vector2d middle = Vector2d::Zero();
        const MapLine& ring = shelter.polygon.rings.at(0);
        for (const MapPoint& p : ring) middle += Vector2d(p.x, p.z) / static_cast<double>(ring.size());
        if ((middle - place).squaredNorm() >= least) continue;
        least = (middle - place).squaredNorm();
        nearest = middle;
    }
    return nearest;
}

// Adds an agent of group g; line: tau of the group over time.
void add_agent(Agents& agents, const Scene& scene, std::size_t g, const Vector2d& place, const PersonRow& person,
               const TauLine& line) {
    const AgentGroup& group = scene.crowd->groups[g];
    const std::size_t id = agents.size();
    agents.position.push_back(place);
    const bool to_shelters = scene.site && group.goals == GoalRule::shelters;
    agents.goal.push_back(to_shelters ? nearest_shelter(scene, place) : Vector2d(group.goal_x, group.goal_z));
    agents.desired_speed.push_back(group.desired_speed);
    agents.tau.push_back(group.tau ? group.tau->at(random_of(scene, id, draw_tau)) : 0);
    add_tau_line(agents, id, person, line);
    const bool by_body = scene.crowd->response == ResponseKind::measured && !group.tau;
    const auto draw = [&](Draw which) { return random_of(scene, id, which); };
    agents.mass.push_back(add_person(
        agents.people, group, person, by_body,
        {draw(draw_sex), draw(draw_height), draw(draw_age), draw(draw_friction), draw(draw_drowns), draw(draw_mass)}));
    agents.group.push_back(static_cast<std::uint32_t>(g));
    agents.outcome.push_back(Outcome::active);
    if (!scene.site) return;
    agents.house.push_back(-1);
    agents.leaves.push_back(0);
    agents.goes_up.push_back(0);
    agents.door_depth.push_back(0);
}

// Puts an agent into its house, with its departure time and the choice of the upper floor.
void let_live_indoors(Agents& agents, const Scene& scene, std::size_t id, const Lodger& lodger) {
    const Leaving& leaving = scene.crowd->groups[agents.group[id]].leaving;
    agents.outcome[id] = Outcome::indoors;
    agents.house[id] = lodger.house;
    if (lodger.row != nullptr && lodger.row->leaves_at) {
        agents.leaves[id] = *lodger.row->leaves_at;
    } else {
        const bool stays = random_of(scene, id, draw_stays) < leaving.stay_share;
        agents.leaves[id] = stays ? never : leaving_time(leaving, random_of(scene, id, draw_leaves));
    }
    const House& house = scene.site->houses[static_cast<std::size_t>(lodger.house)];
    const bool wants_up = random_of(scene, id, draw_goes_up) < leaving.upper_floor_share;
    agents.goes_up[id] = wants_up && !std::isnan(house.upper_floor) ? 1 : 0;
}

void add_on_grid(Agents& agents, const Scene& scene, std::size_t g, const TauLine& line) {
    const AgentGroup& group = scene.crowd->groups[g];
    for (int k = 0; k < group.count; ++k) {
        const int column = k % group.columns;
        const int row = k / group.columns;
        const Vector2d place(group.start_x + column * group.pitch_x, group.start_z + row * group.pitch_z);
        check_start(scene.world, g, k, place);
        add_agent(agents, scene, g, place, person_of_table(scene.crowd, group, k, agents.size()), line);
    }
}

// Adds the agents of a group that start in houses, and agents of its table that start outdoors.
void add_lodgers(Agents& agents, const Scene& scene, std::size_t g, const TauLine& line) {
    const PlacedHouses houses = houses_of(scene);
    Doors doors(scene, houses, scene.crowd->body_radius + 1e-3);
    int member = 0;
    for (const Lodger& lodger : lodgers_of(scene, houses, g)) {
        const std::size_t id = agents.size();
        const Vector2d place = lodger.house >= 0 ? doors.place_before(lodger) : Vector2d(lodger.row->x, lodger.row->z);
        check_start(scene.world, g, member, place);
        const PersonRow person = lodger.row != nullptr
                                     ? lodger.row->person
                                     : person_of_table(scene.crowd, scene.crowd->groups[g], member, id);
        add_agent(agents, scene, g, place, person, line);
        if (lodger.house >= 0) let_live_indoors(agents, scene, id, lodger);
        if (lodger.row != nullptr && !lodger.row->id.empty()) {
            agents.resident.resize(id + 1);
            agents.resident[id] = lodger.row->id;
        }
        ++member;
    }
}

}  // namespace

std::string_view outcome_name(Outcome outcome) {
    static constexpr auto names = std::to_array<std::string_view>({
        "active",
#define WADE_OUTCOME(word, kind, end) #word,
#include "configs/scene/states.def"
    });
    return names[static_cast<std::size_t>(outcome)];
}

Agents make_agents(const Scene& scene) {
    Agents agents;
    for (std::size_t g = 0; g < scene.crowd->groups.size(); ++g) {
        const AgentGroup& group = scene.crowd->groups[g];
        TauLine line;
        if (!group.tau_history.empty()) line.points = std::make_shared<const std::vector<TauPoint>>(group.tau_history);
        if (scene.site && group.starts == StartRule::houses) {
            add_lodgers(agents, scene, g, line);
        } else {
            add_on_grid(agents, scene, g, line);
        }
    }
    start_wear(agents.people, scene.crowd);
    draw_starts(scene, agents);
    const std::size_t n = agents.position.size();
    for (std::size_t id = 0; id < n; ++id)
        agents.heading.push_back(unit_or(agents.goal[id] - agents.position[id], Vector2d::Zero()));
    agents.laps.assign(n, 0);
    agents.velocity.assign(n, Vector2d::Zero());
    agents.momentary.assign(n, Vector2d::Zero());
    agents.start = agents.position;
    agents.end_step.assign(n, 0);
    agents.lost_feet_step.assign(n, 0);
    agents.end_before.assign(n, 0.0);
    agents.path_length.assign(n, 0.0);
    agents.max_depth.assign(n, 0.0);
    agents.max_dv.assign(n, 0.0);
    agents.wet_steps.assign(n, 0);
    agents.depth_sum.assign(n, 0.0);
    agents.dv_sum.assign(n, 0.0);
    agents.tau_sum.assign(n, 0.0);
    agents.stay = agents.position;
    agents.stay_step.assign(n, 0);
    agents.stay_wet_steps.assign(n, 0);
    agents.standing.assign(n, false);
    return agents;
}

}  // namespace wade::crowd
