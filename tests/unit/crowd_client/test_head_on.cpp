// People who meet head-on: points with redrawn markers pass, whatever their way, their speed and the rate of the steps.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "crowd_client/crowd_world.hpp"
#include "crowd_client/markers/marker_lanes.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::MadeUpWater;

namespace {

Scene empty_ground(std::uint64_t seed, double rate) {
    Scene scene;
    scene.seed = seed;
    scene.frame_rate = scene.crowd.step_rate = rate;
    scene.world = {40, 40, 9.81, Ends::open};
    scene.channel.x = scene.channel.z = {0, 40};
    scene.channel.flow = Flow::closed;
    scene.crowd.markers = MarkerRule::redrawn;
    scene.crowd.goal_radius = 0.5;
    return scene;
}

void add_walker(Scene& scene, const Vector2d& from, const Vector2d& to, double speed) {
    AgentGroup group;
    group.name = "walker" + std::to_string(scene.crowd.groups.size());
    group.start_x = from.x();
    group.start_z = from.y();
    group.goal_x = to.x();
    group.goal_z = to.y();
    group.desired_speed = speed;
    scene.crowd.groups.push_back(group);
}

// The time until all are there, s.
double time_to_pass(const Scene& scene) {
    CrowdWorld crowd = make_crowd(scene);
    const MadeUpWater none;
    while (!crowd.active.empty() && static_cast<double>(crowd.steps) * crowd.dt < 120) step(crowd, none.view());
    CHECK(crowd.arrived == crowd.agents.size());
    return static_cast<double>(crowd.steps) * crowd.dt;
}

}  // namespace

TEST_CASE("Two people who are exactly opposite pass within four seconds more than their way takes") {
    const double rate = GENERATE(10.0, 30.0);
    const double angle = GENERATE(0.0, 0.5, 0.25, 0.1) * std::numbers::pi;
    const double way = GENERATE(3.0, 10.0), speed = GENERATE(0.8, 1.3);
    const Vector2d along(std::cos(angle), std::sin(angle));
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        // On a border of sub-cells, in their middle and between.
        const Vector2d middle(20 + 0.06 * static_cast<double>(seed - 1), 20);
        Scene scene = empty_ground(seed, rate);
        add_walker(scene, middle - way / 2 * along, middle + way / 2 * along, 1.3);
        add_walker(scene, middle + way / 2 * along, middle - way / 2 * along, speed);
        INFO("seed " << seed << ", angle " << angle << ", " << rate << " Hz, way " << way << " m, speed " << speed);
        CHECK(time_to_pass(scene) < way / speed + 4);
    }
}

TEST_CASE("One person passes two who come in a row, at any density of markers and beside a wall") {
    const int markers = GENERATE(25, 64, 100);
    const double z = GENERATE(0.0, 20.0);
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        Scene scene = empty_ground(seed, 30);
        scene.crowd.markers_per_cell = markers;
        add_walker(scene, {15, z}, {25, z}, 1.3);
        add_walker(scene, {25, z}, {15, z}, 1.3);
        add_walker(scene, {26, z}, {15, z}, 1.3);
        INFO("seed " << seed << ", " << markers << " markers, z " << z);
        CHECK(time_to_pass(scene) < 14);
    }
}

TEST_CASE("Redrawn markers of points are in the mean everywhere alike, those of bodies keep to their sub-cells") {
    Scene scene = empty_ground(3, 30);
    scene.crowd.bodies = GENERATE(BodyRule::none, BodyRule::fast);
    DrawnMarkers drawn = place_markers(scene).drawn;
    MarkerLanes<float> cell;
    constexpr int strips = 10, epochs = 400;  // of a sub-cell of 0.25 m
    std::vector<double> count(strips, 0);
    for (std::uint64_t epoch = 1; epoch <= epochs; ++epoch) {
        redraw(drawn, epoch);
        draw_markers(cell, drawn, 5, 5);
        for (std::size_t m = 0; m < cell.count; ++m) {
            const double x = cell.origin_x + drawn.moved.x() + static_cast<double>(cell.x[m]);
            ++count[static_cast<std::size_t>(std::fmod(x, 0.25) / 0.25 * strips)];
        }
    }
    const auto [least, most] = std::minmax_element(count.begin(), count.end());
    const double mean = 64.0 * epochs / strips;
    if (scene.crowd.bodies == BodyRule::none) {
        // The markers of an epoch move together, so that a strip has 400 independent values: two strips in five empty in
        // each, its mean is known to 4 % of itself. Five times that.
        CHECK(*least > 0.8 * mean);
        CHECK(*most < 1.2 * mean);
    } else {
        CHECK(*least == 0);
    }
}
