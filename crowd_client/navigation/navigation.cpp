#include "crowd_client/navigation/navigation.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <sstream>
#include <string>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/markers/ground_grid.hpp"
#include "crowd_client/navigation/travel_time_fields.hpp"

namespace wade::crowd {
namespace {

constexpr int laps_laid_out = 5, lap_of_goals = 2;  // of a periodic world

// W(rho) of the header, at least 0.1.
double weidmann(double density) {
    if (!(density > 0)) return 1;
    constexpr double rate = 1.913, jam = 5.4;  // 1/m2
    return std::max(0.1, 1 - std::exp(-rate * (1 / density - 1 / jam)));
}

int columns_of_a_lap(const Navigation& navigation) {
    const int columns = navigation.grid.columns;
    return navigation.period > 0 ? (columns - 1) / laps_laid_out : columns;
}

void add_person(Navigation& navigation, const Vector2d& p) {
    const TravelGrid& grid = navigation.grid;
    const int columns = columns_of_a_lap(navigation);
    const double x0 = navigation.period > 0 ? 0 : grid.origin.x(), z0 = grid.origin.y();
    const double lx = std::max(GroundGrid::cell_size, grid.dx), lz = std::max(GroundGrid::cell_size, grid.dz);
    const auto hat = [](double distance, double l) { return std::max(0.0, 1 - std::abs(distance) / l) / l; };
    const int first_row = std::max(0, static_cast<int>(std::ceil((p.y() - lz - z0) / grid.dz)));
    const int last_row = std::min(grid.rows - 1, static_cast<int>(std::floor((p.y() + lz - z0) / grid.dz)));
    const int first = static_cast<int>(std::ceil((p.x() - lx - x0) / grid.dx));
    const int last = static_cast<int>(std::floor((p.x() + lx - x0) / grid.dx));
    for (int row = first_row; row <= last_row; ++row) {
        const double share = hat(z0 + row * grid.dz - p.y(), lz);
        for (int column = first; column <= last; ++column) {
            int in_lap = column;
            if (navigation.period > 0) in_lap = ((column % columns) + columns) % columns;
            if (in_lap < 0 || in_lap >= columns) continue;
            navigation.density[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                               static_cast<std::size_t>(in_lap)] += share * hat(x0 + column * grid.dx - p.x(), lx);
        }
    }
}

}  // namespace

void find_slowness(Navigation& navigation, std::span<const Vector2d> positions) {
    const TravelGrid& grid = navigation.grid;
    const auto columns = static_cast<std::size_t>(columns_of_a_lap(navigation));
    navigation.density.assign(columns * static_cast<std::size_t>(grid.rows), 0.0);
    for (const Vector2d& p : positions) add_person(navigation, p);
    navigation.slowness.resize(grid.closed.size());
    for (int row = 0; row < grid.rows; ++row) {
        for (int column = 0; column < grid.columns; ++column) {
            const std::size_t place =
                static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column) % columns;
            navigation.slowness[grid.node(column, row)] = 1 / weidmann(navigation.crowding * navigation.density[place]);
        }
    }
}

namespace {

void solve(Navigation& navigation, std::span<const Vector2d> positions, int threads) {
    if (navigation.crowding > 0) find_slowness(navigation, positions);
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (std::size_t i = 0; i < navigation.fields.size(); ++i) {
        TravelTimeField& field = navigation.fields[i];
        march(field.travel, field.memory, navigation.grid, navigation.slowness, field.starts);
    }
}

void find_views(const Navigation& navigation, TravelTimeField& field) {
    const TravelGrid& grid = navigation.grid;
    field.views.assign(grid.closed.size(), View::unknown);
    field.hiding_start.assign(grid.closed.size() + 1, 0);
    field.hiding.clear();
    for (int row = 0; row < grid.rows; ++row) {
        for (int column = 0; column < grid.columns; ++column) {
            std::uint32_t& end = field.hiding_start[grid.node(column, row) + 1];
            end = static_cast<std::uint32_t>(field.hiding.size());
            if (row + 1 == grid.rows || column + 1 == grid.columns) continue;  // no cell
            const Vector2d lo = grid.place(column, row), hi = grid.place(column + 1, row + 1);
            field.views[grid.node(column, row)] =
                view_of(navigation.sight, {lo.x(), hi.x()}, {lo.y(), hi.y()}, field.goal, &field.hiding);
            end = static_cast<std::uint32_t>(field.hiding.size());
        }
    }
}

double nodes_of(const Scene& scene, double cell) {
    const double laps = scene.world->period() > 0 ? laps_laid_out : 1;
    return (laps * scene.world->length / cell + 1) * (scene.world->width / cell + 1);
}

void check_size(const Scene& scene, std::size_t goals) {
    const double cell = scene.crowd->navigation.cell, all = nodes_of(scene, cell) * static_cast<double>(goals);
    if (all <= max_field_nodes) return;
    std::ostringstream message;
    message << "/crowd/navigation/cell_m is " << cell << ", which makes " << all << " cells for " << goals
            << " goals; allowed is up to " << max_field_nodes << " in all, about "
            << cell * std::sqrt(all / max_field_nodes) << " m and more here";
    throw ConfigurationError(message.str());
}

// Returns the width of the narrowest gap between two boxes along an axis that a person fits through, less the person,
// at most `most`, m.
double narrowest_gap(const Sight& sight, double most) {
    const double width = 2 * sight.clearance;
    double least = most;
    const auto take = [&](const Interval& a, const Interval& b, const Interval& a_across, const Interval& b_across) {
        const double gap = b.lo - a.hi;
        if (gap <= width || gap - width >= least) return;
        if (a_across.lo < b_across.hi + width && b_across.lo < a_across.hi + width) least = gap - width;
    };
    for (const Obstacle& box : sight.boxes.all) {
        const Obstacle near = grown(box, width + most);
        for_each_near(sight.boxes, near.x, near.z, [&](const Obstacle& other) {
            take(box.x, other.x, box.z, other.z);
            take(box.z, other.z, box.x, other.x);
        });
    }
    return least;
}

// Returns a cell size small enough for each gap, if the fields of all goals still fit into memory, m.
double cell_for_gaps(const Navigation& navigation, const Scene& scene) {
    constexpr double smallest = 0.05;
    const double largest = scene.crowd->navigation.cell;
    const double cell = std::min(largest, std::max(smallest, narrowest_gap(navigation.sight, largest)));
    const auto goals = static_cast<double>(navigation.fields.size());
    return nodes_of(scene, cell) * goals <= max_field_nodes ? cell : largest;
}

void place_boxes_of_way(Navigation& navigation, const Scene& scene) {
    const double period = navigation.period;
    navigation.sight.clearance = least_clearance(scene);
    std::vector<Obstacle> boxes;
    for (int lap = period > 0 ? -lap_of_goals : 0; lap <= (period > 0 ? lap_of_goals : 0); ++lap) {
        for (Obstacle box : scene.obstacles) {
            box.x = {box.x.lo + lap * period, box.x.hi + lap * period};
            boxes.push_back(box);
        }
    }
    constexpr double cell = 4;  // m; wide enough to search for nodes near a position, with few cells on a long segment
    navigation.sight.boxes = place_boxes(std::move(boxes), cell);
}

void lay_out_grid(Navigation& navigation, const Scene& scene, double cell) {
    const double period = navigation.period;
    const double lap_cell = period > 0 ? period / std::ceil(period / cell - 1e-9) : cell;
    navigation.grid =
        period > 0 ? travel_grid({-lap_of_goals * period, 0}, {laps_laid_out * period, scene.world->width}, lap_cell)
                   : travel_grid({0, 0}, {scene.world->length, scene.world->width}, cell);
    finish_grid(navigation, scene);
}

void name_goals(Navigation& navigation, const Agents& agents) {
    std::map<std::pair<double, double>, std::uint32_t> number_of;
    for (const Vector2d& goal : agents.goal) {
        Vector2d image = goal;
        if (const double period = navigation.period; period > 0) {
            image.x() -= period * std::floor(image.x() / period);
            if (image.x() >= period) image.x() = 0;
        }
        const auto [it, is_new] =
            number_of.try_emplace({image.x(), image.y()}, static_cast<std::uint32_t>(navigation.fields.size()));
        if (is_new) navigation.fields.emplace_back().goal = image;
        navigation.field_of.push_back(it->second);
    }
}

// Returns a sentence about the first agent without a route, or nothing. Fields that are not solved are not needed.
std::string first_without_route(const Navigation& navigation, const Scene& scene, const Agents& agents) {
    if (!finds_routes(navigation)) return "";
    std::size_t count = 0, first = 0;
    for (std::size_t id = 0; id < agents.size(); ++id) {
        const TravelTimeField& field = navigation.fields[navigation.field_of[id]];
        const Vector2d& p = agents.position[id];
        if (!field.is_solved() || way_from(navigation, field, p, goal_offset(agents, id, navigation.period))) continue;
        if (count++ == 0) first = id;
    }
    if (count == 0) return "";
    const bool is_straight = scene.crowd->navigation.rule == NavigationRule::straight;
    const double width = 2 * navigation.sight.clearance, cell = std::max(navigation.grid.dx, navigation.grid.dz);
    std::ostringstream message;
    message << "/crowd/groups/" << agents.group[first] << ": agent " << first << " of group \""
            << scene.crowd->groups[agents.group[first]].name << "\" starts at (" << agents.position[first].x() << ", "
            << agents.position[first].y() << ") m without a way to its goal (" << agents.goal[first].x() << ", "
            << agents.goal[first].y() << ") m";
    if (count > 1) message << ", as do " << count - 1 << " more";
    message << (is_straight ? "; it takes" : "; allowed:") << " a way between the obstacles that is more than " << width
            << " m wide (" << width / scene.crowd->body_radius
            << " /crowd/body_radius_m), and for certain found if it is " << width << " m plus a cell of " << cell
            << " m (/crowd/navigation/cell_m)" << (is_straight ? "" : ", or /crowd/navigation/rule straight");
    return message.str();
}

void prepare(const Navigation& navigation, TravelTimeField& field) {
    field.starts.clear();
    start_at_goal(navigation, field);
    if (navigation.period == 0) find_views(navigation, field);
}

// Returns whether the goal, or a position of arrival, is visible.
bool sees_its_goal(const Navigation& navigation, const Vector2d& p, const Vector2d& rest) {
    const double length = std::sqrt(rest.squaredNorm());
    if (length <= navigation.goal_radius) return true;
    return sees_along(navigation, p, (1 - navigation.goal_radius / length) * rest);
}

// Solves the fields of goals hidden from their agents, as long as memory lasts.
void solve_where_needed(Navigation& navigation, const Scene& scene, std::span<const std::uint32_t> active,
                        std::span<const Vector2d> positions, std::span<const Vector2d> goal_offsets, int threads) {
    if (navigation.solved == navigation.fields.size()) return;
    std::vector<std::uint32_t> needed;
    std::vector<bool> is_needed(navigation.fields.size());
    for (std::size_t k = 0; k < active.size(); ++k) {
        const std::uint32_t f = navigation.field_of[active[k]];
        if (navigation.fields[f].is_solved() || is_needed[f]) continue;
        if (sees_its_goal(navigation, positions[k], goal_offsets[k])) continue;
        is_needed[f] = true;
        needed.push_back(f);
    }
    if (needed.empty()) return;
    if (navigation.grid.closed.empty()) {
        if (nodes_of(scene, scene.crowd->navigation.cell) > max_field_nodes) return;
        lay_out_grid(navigation, scene, cell_for_gaps(navigation, scene));
    }
    const auto room = static_cast<std::size_t>(max_field_nodes) / navigation.grid.closed.size();
    needed.resize(std::min(needed.size(), room - std::min(room, navigation.solved)));
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (std::size_t i = 0; i < needed.size(); ++i) {
        TravelTimeField& field = navigation.fields[needed[i]];
        prepare(navigation, field);
        march(field.travel, field.memory, navigation.grid, navigation.slowness, field.starts);
    }
    navigation.solved += needed.size();
}

void solve_all(Navigation& navigation, const Scene& scene, const Agents& agents, double cell) {
    lay_out_grid(navigation, scene, cell);
    for (TravelTimeField& field : navigation.fields) prepare(navigation, field);
    solve(navigation, agents.position, 1);
    navigation.solved = navigation.fields.size();
}

std::uint64_t steps_in(double time, const Scene& scene) {
    return static_cast<std::uint64_t>(std::max(1.0, std::round(time * scene.crowd->step_rate)));
}

// Returns the offset along the route, zero where the agent walks straight.
Vector2d look_for_way(const Navigation& navigation, std::uint32_t id, const Vector2d& p, const Vector2d& rest) {
    const TravelTimeField& field = navigation.fields[navigation.field_of[id]];
    if (!field.is_solved()) return Vector2d::Zero();
    const std::optional<Vector2d> way = way_from(navigation, field, p, rest);
    return way && *way != rest ? *way : Vector2d::Zero();
}

}  // namespace

void start_at_goal(const Navigation& navigation, TravelTimeField& field) {
    const TravelGrid& grid = navigation.grid;
    for (int row = 0; row < grid.rows; ++row) {
        for (int column = 0; column < grid.columns; ++column) {
            const Vector2d node = grid.place(column, row), way = node - field.goal;
            const double length = std::sqrt(way.squaredNorm());
            if (length > navigation.start_radius || !in_sight(navigation.sight, field.goal, node)) continue;
            field.starts.emplace_back(grid.node(column, row), length);
        }
    }
}

void finish_grid(Navigation& navigation, const Scene& scene) {
    for (const Obstacle& box : navigation.sight.boxes.all) {
        close_box(navigation.grid, grown(box, navigation.sight.clearance));
    }
    close_houses(navigation.grid, navigation.sight.houses, navigation.sight.clearance);
    // Reaches from the cell of a position within the clearance to the nodes outside it, and one on.
    const double widest = std::max(navigation.grid.dx, navigation.grid.dz);
    const double narrowest = std::min(navigation.grid.dx, navigation.grid.dz);
    constexpr int most_reach = 31;
    navigation.reach = std::min(most_reach, 1 + static_cast<int>(std::ceil(navigation.sight.clearance / narrowest)));
    navigation.start_radius = std::max(scene.crowd->goal_radius, 2 * widest);
}

double least_clearance(const Scene& scene) {
    const bool turns = scene.crowd->bodies != BodyRule::none;
    return (turns ? turned_share : 1) * scene.crowd->body_radius;
}

Navigation make_navigation(const Scene& scene, const Agents& agents) {
    constexpr double time_between_looks = 1;        // between checks for needed fields, s
    constexpr double time_between_decisions = 0.1;  // s; bodies decide as often by themselves
    const NavigationSettings& settings = scene.crowd->navigation;
    Navigation navigation;
    const bool nothing_in_the_way = scene.obstacles.empty() && settings.crowding == 0;
    if (settings.rule == NavigationRule::straight || nothing_in_the_way || agents.size() == 0) return navigation;
    if (scene.crowd->bodies == BodyRule::none) {
        const double decisions = time_between_decisions * scene.crowd->step_rate;
        navigation.looks_between = static_cast<std::uint64_t>(std::max(1.0, std::floor(decisions + 1e-9)));
    }
    navigation.way.assign(agents.size(), Vector2d::Zero());
    navigation.crowding = settings.crowding;
    navigation.only_where_needed = settings.rule == NavigationRule::automatic && settings.crowding == 0;
    navigation.period = scene.world->period();
    navigation.goal_radius = scene.crowd->goal_radius;
    name_goals(navigation, agents);
    place_boxes_of_way(navigation, scene);
    if (navigation.only_where_needed) {
        navigation.steps_between = steps_in(time_between_looks, scene);
        std::vector<std::uint32_t> all(agents.size());
        std::iota(all.begin(), all.end(), 0U);
        std::vector<Vector2d> offsets;
        for (std::size_t id = 0; id < agents.size(); ++id)
            offsets.push_back(goal_offset(agents, id, navigation.period));
        solve_where_needed(navigation, scene, all, agents.position, offsets, 1);
        return navigation;
    }
    if (settings.every > 0) navigation.steps_between = steps_in(settings.every, scene);
    check_size(scene, navigation.fields.size());
    solve_all(navigation, scene, agents, settings.cell);
    if (first_without_route(navigation, scene, agents).empty()) return navigation;
    solve_all(navigation, scene, agents, cell_for_gaps(navigation, scene));
    const std::string no_way = first_without_route(navigation, scene, agents);
    if (!no_way.empty()) throw ConfigurationError(no_way);
    return navigation;
}

std::string people_without_route(const Navigation& navigation, const Scene& scene, const Agents& agents) {
    if (scene.crowd->navigation.rule != NavigationRule::straight) return first_without_route(navigation, scene, agents);
    constexpr double worth_a_look = 5e6;  // nodes; some seconds
    const auto goals = static_cast<double>(scene.crowd->groups.size());
    if (nodes_of(scene, scene.crowd->navigation.cell) * goals > worth_a_look) return "";
    Scene led = scene;
    led.crowd->navigation.rule = NavigationRule::automatic;
    led.crowd->navigation.crowding = 0;
    return first_without_route(make_navigation(led, agents), scene, agents);
}

void update_navigation(Navigation& navigation, const Scene& scene, std::span<const std::uint32_t> active,
                       std::span<const Vector2d> positions, std::span<const Vector2d> goal_offsets, int threads) {
    if (navigation.only_where_needed) {
        solve_where_needed(navigation, scene, active, positions, goal_offsets, threads);
    } else if (navigation.crowding > 0) {
        solve(navigation, positions, threads);
    }
}

void steer(Navigation& navigation, std::span<const std::uint32_t> active, std::span<const Vector2d> positions,
           std::span<Vector2d> goal_offsets, std::uint64_t decision, int threads) {
    if (navigation.solved == 0) return;
    const bool looks = decision % navigation.looks_between == 0;
#pragma omp parallel for num_threads(threads) if (threads > 1)
    for (std::size_t k = 0; k < active.size(); ++k) {
        Vector2d& way = navigation.way[active[k]];
        if (looks) way = look_for_way(navigation, active[k], positions[k], goal_offsets[k]);
        if (way != Vector2d::Zero()) goal_offsets[k] = way;
    }
}

Navigation ways_within(const Scene& scene, const Walls& walls, const Interval& x, const Interval& z,
                       const Vector2d& goal) {
    constexpr double smallest = 0.25, cell_of_boxes = 4;  // m
    Navigation navigation;
    navigation.goal_radius = scene.crowd->goal_radius;
    navigation.sight.clearance = least_clearance(scene);
    std::vector<Obstacle> near;
    for_each_near(walls.boxes, x, z, [&](const Obstacle& box) { near.push_back(box); });
    std::vector<MapPolygon> plans;
    for_each_near(walls.houses.grounds, x, z,
                  [&](const Obstacle& ground) { plans.push_back(walls.houses.plan_on(ground)); });
    navigation.sight.houses = place_houses(std::move(plans));
    navigation.sight.boxes = place_boxes(std::move(near), cell_of_boxes);
    const double largest = scene.crowd->navigation.cell;
    const double cell = std::min(largest, std::max(smallest, narrowest_gap(navigation.sight, largest)));
    navigation.grid = travel_grid({x.lo, z.lo}, {x.length(), z.length()}, cell);
    finish_grid(navigation, scene);
    TravelTimeField& field = navigation.fields.emplace_back();
    field.goal = goal;
    start_at_goal(navigation, field);
    march(field.travel, field.memory, navigation.grid, navigation.slowness, field.starts);
    navigation.solved = 1;
    return navigation;
}

}  // namespace wade::crowd
