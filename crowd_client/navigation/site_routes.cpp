#include "crowd_client/navigation/site_routes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/site.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/navigation/navigation.hpp"

namespace wade::crowd {
namespace {

constexpr double look_ahead = 1;  // m, the distance at which an agent waits before water that it does not enter
double reach_of_shelters(const Navigation& navigation) {
    const double widest = std::max(navigation.grid.dx, navigation.grid.dz);
    return std::max(shelter_reach, navigation.sight.clearance + 1.5 * widest);
}

// Returns the offset from p to the nearest point of a shelter, m; zero in it.
Vector2d way_to_shelter(const PlacedHouses& shelters, std::size_t shelter, const Vector2d& p) {
    if (contains(shelters.plans[shelter], {p.x(), p.y()})) return Vector2d::Zero();
    Vector2d nearest = Vector2d::Constant(1e9);
    for (std::uint32_t k = shelters.first_side[shelter]; k < shelters.first_side[shelter + 1]; ++k) {
        const HouseSide& side = shelters.sides[k];
        const Vector2d way = side.at(side.nearest(p)) - p;
        if (way.squaredNorm() < nearest.squaredNorm()) nearest = way;
    }
    return nearest;
}

// Returns the nearest shelter with free capacity within a reach, m, and the offset to it; the first of equal ones.
std::optional<std::pair<std::size_t, Vector2d>> shelter_near(const SiteRoutes& site, const Vector2d& p, double reach) {
    std::optional<std::pair<std::size_t, Vector2d>> nearest;
    double least = reach * reach;
    for_each_near(site.shelters.grounds, {p.x() - reach, p.x() + reach}, {p.y() - reach, p.y() + reach},
                  [&](const Obstacle& ground) {
                      const auto shelter = static_cast<std::size_t>(&ground - site.shelters.grounds.all.data());
                      if (site.is_full(shelter)) return;
                      const Vector2d way = way_to_shelter(site.shelters, shelter, p);
                      if (way.squaredNorm() > least || (nearest && way.squaredNorm() == least)) return;
                      least = way.squaredNorm();
                      nearest = {shelter, way};
                  });
    return nearest;
}

// Finds once the nodes around each shelter, with the distance left from there, and the nodes of high ground.
void find_starts(Navigation& navigation) {
    SiteRoutes& site = *navigation.site;
    const TravelGrid& grid = navigation.grid;
    const double reach = reach_of_shelters(navigation);
    site.starts.resize(site.shelters.plans.size());
    for (std::size_t shelter = 0; shelter < site.starts.size(); ++shelter) {
        const Obstacle near = grown(site.shelters.grounds.all[shelter], reach);
        const auto line = [](double at, double origin, double spacing, int count) {
            return static_cast<int>(std::clamp(std::floor((at - origin) / spacing), 0.0, count - 1.0));
        };
        for (int row = line(near.z.lo, grid.origin.y(), grid.dz, grid.rows);
             row <= line(near.z.hi, grid.origin.y(), grid.dz, grid.rows); ++row) {
            for (int column = line(near.x.lo, grid.origin.x(), grid.dx, grid.columns);
                 column <= line(near.x.hi, grid.origin.x(), grid.dx, grid.columns); ++column) {
                const Vector2d node = grid.place(column, row);
                const double left = way_to_shelter(site.shelters, shelter, node).norm();
                if (left <= reach) site.starts[shelter].emplace_back(grid.node(column, row), left);
            }
        }
    }
    for (int row = 0; row < grid.rows && site.safe_above; ++row) {
        for (int column = 0; column < grid.columns; ++column) {
            const Vector2d node = grid.place(column, row);
            if (ground_height(site.ground, {node.x(), node.y()}) < *site.safe_above) continue;
            site.high_ground.emplace_back(grid.node(column, row), 0.0);
        }
    }
}

void add_starts(const Navigation& navigation, TravelTimeField& field) {
    const SiteRoutes& site = *navigation.site;
    if (field.has_point) return;
    field.starts = site.high_ground;
    for (std::size_t shelter = 0; shelter < site.starts.size(); ++shelter) {
        if (site.is_full(shelter)) continue;
        field.starts.insert(field.starts.end(), site.starts[shelter].begin(), site.starts[shelter].end());
    }
}

void solve_fields(Navigation& navigation, std::span<const Vector2d> positions, int threads) {
    const SiteRoutes& site = *navigation.site;
    const bool has_crowding = navigation.crowding > 0;
    if (has_crowding) find_slowness(navigation, positions);
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (std::size_t i = 0; i < navigation.fields.size(); ++i) {
        TravelTimeField& field = navigation.fields[i];
        add_starts(navigation, field);
        const GroupRoutes& group = site.groups[i / 2];
        const bool may_differ = site.have_shelters_changed || has_crowding;
        if (field.is_solved() && i % 2 == 1 && !may_differ) continue;  // no water
        if (i % 2 == 1 && !group.has_unwarned) continue;
        const bool knows = i % 2 == 0 && !group.slowness.empty();
        const std::vector<double>& of_ground = knows ? group.slowness : site.dry;
        std::vector<double> of_both = navigation.slowness;
        for (std::size_t n = 0; has_crowding && n < of_ground.size(); ++n) of_both[n] *= of_ground[n];
        march(field.travel, field.memory, navigation.grid, has_crowding ? of_both : of_ground, field.starts);
    }
}

// Adds the mean person of a group, and its two fields: one that knows the water, and one that does not.
void add_group(Navigation& navigation, const Scene& scene, const Agents& agents, std::size_t g,
               const std::vector<std::uint32_t>& members) {
    const AgentGroup& group = scene.crowd->groups[g];
    GroupRoutes& ways = navigation.site->groups.emplace_back();
    ways.to_shelters = group.goals == GoalRule::shelters;
    ways.has_unwarned = !group.warned;
    PersonRow mean;
    double height = 0, friction = 0, arm = 0, age = 0;
    const People& people = agents.people;
    for (const std::uint32_t id : members) {
        height += people.height[id];
        friction += people.friction[id];
        arm += people.arm[id] / people.height[id];
        age += people.age[id];
        ways.mass += agents.mass[id];
        ways.men += people.sex[id] == Sex::male ? 1 : 0;
    }
    const double n = std::max<double>(1, static_cast<double>(members.size()));
    mean.height = members.empty() ? usual_height : height / n;
    mean.ground_friction = members.empty() ? 0.45 : friction / n;
    mean.bracing_arm = members.empty() ? 0.09 : arm / n;
    mean.age = members.empty() ? 30 : age / n;
    ways.mass = members.empty() ? 65 : ways.mass / n;
    ways.men /= n;
    add_person(ways.person, group, mean, true, {0, 0, 0, 0, 0});
    for (int k = 0; k < 2; ++k) {
        TravelTimeField& field = navigation.fields.emplace_back();
        field.has_point = !ways.to_shelters;
        field.goal = {group.goal_x, group.goal_z};
    }
}

std::vector<std::vector<std::uint32_t>> members_of_groups(const Scene& scene, const Agents& agents) {
    std::vector<std::vector<std::uint32_t>> members(scene.crowd->groups.size());
    for (std::uint32_t id = 0; id < agents.size(); ++id) members[agents.group[id]].push_back(id);
    return members;
}

void check_shelters(const Scene& scene) {
    for (std::size_t g = 0; g < scene.crowd->groups.size(); ++g) {
        const AgentGroup& group = scene.crowd->groups[g];
        if (group.goals != GoalRule::shelters) continue;
        std::ostringstream message;
        message << "/crowd/groups/" << g << "/goal/to: group \"" << group.name << "\" goes to shelters, but ";
        if (scene.crowd->navigation.rule == NavigationRule::straight) {
            message << "/crowd/navigation/rule is straight; allowed: auto or travel_time";
        } else if (scene.site->shelters.empty() && !scene.crowd->navigation.safe_above) {
            message << "there are none; allowed: /site/shelters, /crowd/navigation/safe_above_m, or a goal/to point";
        } else {
            continue;
        }
        throw ConfigurationError(message.str());
    }
}

void check_size(const Navigation& navigation, const Scene& scene) {
    const double nodes = static_cast<double>(navigation.grid.closed.size()), cell = scene.crowd->navigation.cell;
    const std::vector<GroupRoutes>& groups = navigation.site->groups;
    const auto unwarned =
        std::count_if(groups.begin(), groups.end(), [](const GroupRoutes& g) { return g.has_unwarned; });
    const double all = nodes * static_cast<double>(groups.size() + static_cast<std::size_t>(unwarned));
    if (all <= max_field_nodes) return;
    std::ostringstream message;
    message << "/crowd/navigation/cell_m is " << cell << ", which makes " << all << " cells of ways for "
            << scene.crowd->groups.size() << " groups; allowed is up to " << max_field_nodes << " in all, about "
            << cell * std::sqrt(all / max_field_nodes) << " m and more here, or fewer groups";
    throw ConfigurationError(message.str());
}

// Returns whether water that the agent does not enter is visible ahead.
bool sees_shut_water(const Navigation& navigation, const GroupRoutes& group, const Vector2d& p, const Vector2d& along) {
    const SiteRoutes& site = *navigation.site;
    const double step = std::min(site.cells.step_x, site.cells.step_z);
    for (double s = step; s <= site.sight; s += step) {
        const Vector2d there = p + s * along;
        if (group.shut[site.cell_at(there)] == 0) continue;
        return !meets_a_house(navigation.sight.houses, p, there);
    }
    return false;
}

// Returns the offset along the route of one agent, zero where it waits.
Vector2d way_in_site(Navigation& navigation, std::uint32_t id, std::uint32_t of_group, const Vector2d& p,
                     const Vector2d& rest) {
    SiteRoutes& site = *navigation.site;
    const GroupRoutes& group = site.groups[of_group];
    const auto along_field = [&]() -> std::optional<Vector2d> {
        if (group.to_shelters) {
            const auto near = shelter_near(site, p, reach_of_shelters(navigation));
            if (near && !meets_a_house(navigation.sight.houses, p, p + 0.9 * near->second)) return near->second;
        }
        return way_from(navigation, navigation.fields[navigation.field_of[id]], p, rest);
    };
    std::optional<Vector2d> way = along_field();
    if (!way) return Vector2d::Zero();
    if (group.shut.empty()) return *way;
    const Vector2d along = unit_or(*way, Vector2d::Zero());
    if (site.knows[id] == 0 && sees_shut_water(navigation, group, p, along)) {
        site.knows[id] = 1;
        navigation.field_of[id] = 2 * of_group;
        return way_in_site(navigation, id, of_group, p, rest);
    }
    const bool is_out = group.shut[site.cell_at(p)] == 0;
    return is_out && group.shut[site.cell_at(p + look_ahead * along)] != 0 ? Vector2d(0, 0) : *way;
}

}  // namespace

Navigation make_site_routes(const Scene& scene, const Agents& agents) {
    check_shelters(scene);
    Navigation navigation;
    const NavigationSettings& settings = scene.crowd->navigation;
    if (settings.rule == NavigationRule::straight || agents.size() == 0) return navigation;
    constexpr double time_between_decisions = 0.1;  // s; bodies decide as often by themselves
    if (scene.crowd->bodies == BodyRule::none) {
        navigation.looks_between = static_cast<std::uint64_t>(
            std::max(1.0, std::floor(time_between_decisions * scene.crowd->step_rate + 1e-9)));
    }
    if (settings.every > 0) {
        navigation.steps_between =
            static_cast<std::uint64_t>(std::max(1.0, std::round(settings.every * scene.crowd->step_rate)));
    }
    navigation.way.assign(agents.size(), Vector2d::Zero());
    navigation.crowding = settings.crowding;
    navigation.goal_radius = scene.crowd->goal_radius;
    navigation.by_fields_alone = true;
    navigation.sight.clearance = least_clearance(scene);
    navigation.sight.houses = houses_of(scene);
    navigation.grid = travel_grid({0, 0}, {scene.world->length, scene.world->width}, settings.cell);
    finish_grid(navigation, scene);

    SiteRoutes& site = navigation.site.emplace();
    constexpr double step = GroundGrid::cell_size;
    site.cells = {0,
                  0,
                  step,
                  step,
                  static_cast<std::size_t>(std::ceil(scene.world->length / step)),
                  static_cast<std::size_t>(std::ceil(scene.world->width / step))};
    site.ground = scene.site->ground;
    site.ground_step = std::max(1.0, site.ground.raster ? site.ground.raster->cell : 0.0);
    site.slope = settings.slope;
    site.sight = settings.sight;
    site.enters_up_to = settings.enters_up_to;
    site.safe_above = settings.safe_above;
    std::vector<MapPolygon> plans;
    for (const SiteShelter& shelter : scene.site->shelters) {
        plans.push_back(shelter.polygon);
        site.capacity.push_back(static_cast<std::size_t>(shelter.capacity));
    }
    site.shelters = place_houses(std::move(plans));
    site.taken.assign(site.capacity.size() + 1, 0);
    const auto members = members_of_groups(scene, agents);
    for (std::size_t g = 0; g < members.size(); ++g) add_group(navigation, scene, agents, g, members[g]);
    check_size(navigation, scene);
    for (std::uint32_t id = 0; id < agents.size(); ++id) {
        const bool knows = scene.crowd->groups[agents.group[id]].warned;
        site.knows.push_back(knows ? 1 : 0);
        navigation.field_of.push_back(2 * agents.group[id] + (knows ? 0 : 1));
    }
    find_starts(navigation);
    find_dry_slowness(navigation);
    find_free_ground(navigation);
    for (TravelTimeField& field : navigation.fields) {
        if (field.has_point) start_at_goal(navigation, field);
    }
    solve_fields(navigation, {}, 1);  // step 1 knows the people outdoors
    navigation.solved = navigation.fields.size();
    if (settings.rule == NavigationRule::travel_time) {
        const std::string no_way = people_cut_off(navigation, scene, agents);
        if (!no_way.empty()) throw ConfigurationError(no_way);
    }
    return navigation;
}

bool are_site_routes_due(const Navigation& navigation, std::uint64_t step) {
    return navigation.site && (step == 1 || navigation.site->is_stale || is_due(navigation, step));
}

void update_site_routes(Navigation& navigation, const Scene& scene, const WaterBins& water, int threads) {
    SiteRoutes& site = *navigation.site;
    site.are_fields_due |= navigation.crowding > 0;
    const bool was_wet = site.is_wet;
    site.is_wet = find_water(site, water, scene.fluid->rest_density);
    if (!site.is_wet && !was_wet && !site.is_stale) return;
    const WaterProperties properties{scene.fluid->rest_density, scene.world->gravity};
    const auto n = static_cast<std::ptrdiff_t>(site.groups.size());
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (std::ptrdiff_t g = 0; g < n; ++g) {
        find_wet_slowness(navigation, site.groups[static_cast<std::size_t>(g)], properties);
    }
    site.have_shelters_changed |= site.is_stale;
    site.is_stale = false;
    site.are_fields_due = true;
}

void solve_due_fields(Navigation& navigation, std::span<const Vector2d> positions, int threads) {
    SiteRoutes& site = *navigation.site;
    if (!site.are_fields_due) return;
    solve_fields(navigation, positions, threads);
    site.are_fields_due = site.have_shelters_changed = false;
}

void steer_in_site(Navigation& navigation, const Agents& agents, std::span<const std::uint32_t> active,
                   std::span<const Vector2d> positions, std::span<Vector2d> goal_offsets, std::uint64_t decision,
                   int threads) {
    const bool looks = decision % navigation.looks_between == 0;
#pragma omp parallel for num_threads(threads) if (threads > 1)
    for (std::size_t k = 0; k < active.size(); ++k) {
        const std::uint32_t id = active[k];
        Vector2d& way = navigation.way[id];
        if (looks) way = way_in_site(navigation, id, agents.group[id], positions[k], goal_offsets[k]);
        if (way != Vector2d::Zero()) goal_offsets[k] = way;
    }
}

std::optional<std::size_t> shelter_at(const Navigation& navigation, const Vector2d& p) {
    const SiteRoutes& site = *navigation.site;
    if (const auto near = shelter_near(site, p, shelter_reach)) return near->first;
    const bool is_high = site.safe_above && ground_height(site.ground, {p.x(), p.y()}) >= *site.safe_above;
    return is_high ? std::optional(site.capacity.size()) : std::nullopt;
}

void take_in(Navigation& navigation, std::size_t shelter) {
    SiteRoutes& site = *navigation.site;
    ++site.taken[shelter];
    if (shelter < site.capacity.size() && site.is_full(shelter)) site.is_stale = true;
}

namespace {

// Whether an agent at p is at its goal or has a route to it.
bool has_route(const Navigation& navigation, const Agents& agents, std::size_t id, const Vector2d& p) {
    const TravelTimeField& field = navigation.fields[navigation.field_of[id]];
    if (!field.has_point && shelter_at(navigation, p)) return true;
    return way_from(navigation, field, p, agents.goal[id] - p).has_value();
}

}  // namespace

std::string choose_doors(const Navigation& navigation, const Scene& scene, Agents& agents) {
    if (!navigation.site) return "";
    Doors doors(scene, navigation.sight.houses, scene.crowd->body_radius + 1e-3);
    std::size_t count = 0;
    std::vector<std::int32_t> shut;
    for (std::size_t id = 0; id < agents.size(); ++id) {
        if (agents.house[id] < 0 || !std::isfinite(agents.leaves[id]) || agents.goes_up[id] != 0) continue;
        if (has_route(navigation, agents, id, agents.position[id])) continue;
        const std::vector<Vector2d>& others = doors.doors_of(static_cast<std::size_t>(agents.house[id]));
        const auto open = std::find_if(others.begin(), others.end(),
                                       [&](const Vector2d& p) { return has_route(navigation, agents, id, p); });
        if (open != others.end()) {
            agents.position[id] = agents.start[id] = agents.stay[id] = *open;
            continue;
        }
        agents.leaves[id] = std::numeric_limits<double>::infinity();
        ++count;
        if (std::find(shut.begin(), shut.end(), agents.house[id]) == shut.end()) shut.push_back(agents.house[id]);
    }
    if (count == 0) return "";
    const House& first = scene.site->houses[static_cast<std::size_t>(shut[0])];
    std::ostringstream message;
    message << (first.label.empty() ? "/site/houses/" + std::to_string(shut[0]) : first.label);
    if (shut.size() > 1) message << " and " << shut.size() - 1 << " more houses";
    message << ": no route leads from a door to a goal, so that " << count
            << " residents stay indoors for good; allowed: a gap between houses more than "
            << 2 * navigation.sight.clearance << " m wide, or doors elsewhere";
    return message.str();
}

std::string people_cut_off(const Navigation& navigation, const Scene& scene, const Agents& agents) {
    if (!navigation.site) return "";
    std::size_t count = 0, first = 0;
    for (std::size_t id = 0; id < agents.size(); ++id) {
        if (!agents.house.empty() && agents.house[id] >= 0) continue;  // see choose_doors
        if (has_route(navigation, agents, id, agents.position[id])) continue;
        if (count++ == 0) first = id;
    }
    if (count == 0) return "";
    const AgentGroup& group = scene.crowd->groups[agents.group[first]];
    std::ostringstream message;
    message << "/crowd/groups/" << agents.group[first] << ": agent " << first << " of group \"" << group.name
            << "\" starts at (" << agents.position[first].x() << ", " << agents.position[first].y()
            << ") m without a way to " << (group.goals == GoalRule::shelters ? "any shelter" : "its goal");
    if (count > 1) message << ", as do " << count - 1 << " more";
    message << "; allowed: a gap between houses more than " << 2 * navigation.sight.clearance
            << " m wide (/crowd/body_radius_m), a smaller /crowd/navigation/cell_m than "
            << std::max(navigation.grid.dx, navigation.grid.dz) << " m, or a door or start elsewhere";
    return message.str();
}

}  // namespace wade::crowd
