#include "tests/bench/crossing_crowd.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "configs/scene/crowd.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/markers/counter_random.hpp"

namespace wade::bench {
namespace {

using crowd::Vector2d;

void draw_goal(Crossing& crossing, std::size_t id) {
    crossing.crowd.agents.goal[id] = goal_drawn(crossing, id, crossing.goals_reached[id]);
}

// Adds boxes, each in the middle of four starts, on a coarser grid of as many points as boxes, or a few more.
void add_boxes(Scene& scene, std::size_t boxes) {
    const AgentGroup& group = scene.crowd->groups[0];
    const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(boxes))));
    const auto start_before = [&](std::size_t k, int starts) {
        return std::floor((static_cast<double>(k) + 0.5) * starts / static_cast<double>(side));
    };
    for (std::size_t i = 0; i < boxes; ++i) {
        const double x = group.pitch_x * start_before(i % side, group.columns);
        const double z = group.pitch_z * start_before(i / side, group.rows);
        scene.obstacles.push_back({{x - 0.5, x + 0.5}, {z - 0.5, z + 0.5}, 3});
    }
}

}  // namespace

Vector2d goal_drawn(const Crossing& crossing, std::size_t id, std::uint64_t draw) {
    constexpr std::uint64_t stream = std::uint64_t{1} << 41;  // apart from streams of markers and agents
    const Scene& scene = crossing.crowd.scene;
    return {scene.world->length * crowd::counter_uniform(scene.seed, stream + id, 2 * draw),
            scene.world->width * crowd::counter_uniform(scene.seed, stream + id, 2 * draw + 1)};
}

Crossing make_crossing(std::size_t people, double density, const Crowd& settings, std::uint64_t seed,
                       std::size_t boxes) {
    Scene scene;
    scene.seed = seed;
    scene.crowd = settings;
    scene.crowd->navigation.rule = NavigationRule::straight;  // no field knows a goal that is drawn in the walk
    scene.crowd->goal_radius = 1e-6;                          // no agent leaves: goals move away before they are met
    const double side = std::sqrt(static_cast<double>(people) / density);
    scene.world->length = scene.world->width = side;
    AgentGroup group;
    group.name = "walkers";
    group.count = static_cast<int>(people);
    group.columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(people))));
    group.rows = (group.count + group.columns - 1) / group.columns;
    group.pitch_x = side / group.columns;
    group.pitch_z = side / group.rows;
    group.start_x = group.pitch_x / 2;
    group.start_z = group.pitch_z / 2;
    group.start_jitter = std::max(0.0, 0.45 * (std::min(group.pitch_x, group.pitch_z) - 0.51));
    scene.crowd->groups = {group};
    add_boxes(scene, boxes);
    Crossing crossing{crowd::make_crowd(scene), std::vector<std::uint32_t>(people, 0)};
    for (std::size_t id = 0; id < people; ++id) draw_goal(crossing, id);
    return crossing;
}

void walk(Crossing& crossing) {
    crowd::step(crossing.crowd, {});
    const crowd::Agents& agents = crossing.crowd.agents;
    for (std::size_t id = 0; id < agents.size(); ++id) {
        if ((agents.goal[id] - agents.position[id]).squaredNorm() > goal_reach * goal_reach) continue;
        ++crossing.goals_reached[id];
        draw_goal(crossing, id);
    }
}

void add_overlaps(const crowd::Agents& agents, double radius, Overlaps& sum) {
    const std::vector<double>& turned = agents.body.radius;
    const auto radius_of = [&](std::size_t id) { return turned.empty() ? radius : turned[id]; };
    std::vector<std::size_t> order(agents.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto x = [&](std::size_t id) { return agents.position[id].x(); };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return x(a) < x(b); });
    for (std::size_t i = 0; i < order.size(); ++i) {
        for (std::size_t j = i + 1; j < order.size() && x(order[j]) - x(order[i]) < 2 * radius; ++j) {
            const double distance = (agents.position[order[j]] - agents.position[order[i]]).norm();
            const double apart = radius_of(order[i]) + radius_of(order[j]);
            if (distance >= apart) continue;
            ++sum.pairs;
            sum.deepest = std::max(sum.deepest, apart - distance);
        }
    }
}

}  // namespace wade::bench
