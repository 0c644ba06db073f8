#include "crowd_client/crowd_memory.hpp"

#include <set>
#include <utility>

#include "configs/scene/crowd.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/markers/ground_grid.hpp"

namespace wade::crowd {
namespace {

// Measured, bytes.
constexpr double of_marker = 16, of_cell = 40, of_agent = 350, of_particle = 16, of_node = 2, of_node_and_goal = 16;

std::size_t goals_of(const Crowd& crowd) {
    std::set<std::pair<double, double>> goals;
    for (const AgentGroup& group : crowd.groups) goals.emplace(group.goal_x, group.goal_z);
    return goals.size();
}

double memory_of_fields(const Scene& scene) {
    const NavigationSettings& navigation = scene.crowd->navigation;
    const bool needed = !scene.obstacles.empty() || navigation.crowding > 0;
    if (navigation.rule == NavigationRule::straight || !needed) return 0;
    const double laps = scene.world->period() > 0 ? 5 : 1, square = navigation.cell * navigation.cell;
    const double nodes = laps * scene.world->length * scene.world->width / square;
    return nodes * (of_node + of_node_and_goal * static_cast<double>(goals_of(scene.crowd)));
}

}  // namespace

double memory_of_crowd(const Scene& scene) {
    const Crowd& crowd = scene.crowd;
    double agents = 0;
    for (const AgentGroup& group : crowd.groups) agents += group.count;
    const double markers = crowd.markers == MarkerRule::fixed && agents > 0 ? crowd.markers_per_cell : 0;
    return static_cast<double>(GroundGrid::over(scene.world).cells()) * (of_cell + of_marker * markers) +
           of_agent * agents + of_particle * static_cast<double>(particles_expected(scene)) + memory_of_fields(scene);
}

}  // namespace wade::crowd
