// Whole steps of the crowd. People without bodies that meet head-on pass with redrawn markers, whatever their
// direction, their speed and the rate of the steps.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/markers/marker_lanes.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::one_agent_scene;
using wade::crowd::testing::uniform_water;

namespace {

// The start box and the goal of the paper's S1 to S12.
Scene paper_scene(double tau) {
    Scene scene = one_agent_scene(65, 0, 75, 50, tau);
    AgentGroup& group = scene.crowd->groups[0];
    group.columns = 10;
    group.rows = 5;
    group.count = 50;
    group.pitch_x = group.pitch_z = 2.5;
    return scene;
}

void take_steps(CrowdWorld& crowd, const MadeUpWater& water, std::uint64_t count) {
    const WaterView view = water.view();
    for (std::uint64_t i = 0; i < count; ++i) step(crowd, view);
}

}  // namespace

TEST_CASE("Agents start on their grid, row by row, ids counted through the groups") {
    Scene scene = paper_scene(0.2);
    AgentGroup second = scene.crowd->groups[0];
    second.name = "second";
    second.count = 3;
    second.columns = 2;
    second.start_x = 1;
    scene.crowd->groups.push_back(second);
    const Agents agents = make_agents(scene);
    REQUIRE(agents.size() == 53);
    CHECK(agents.position[0] == Vector2d(65, 0));
    CHECK(agents.position[9] == Vector2d(87.5, 0));
    CHECK(agents.position[10] == Vector2d(65, 2.5));
    CHECK(agents.position[49] == Vector2d(87.5, 10));
    CHECK(agents.position[52] == Vector2d(1, 2.5));
    CHECK(agents.group[52] == 1);
}

TEST_CASE("Without water all 50 agents of the paper reach their goal, the last between 38 and 50 s", "[paper]") {
    CrowdWorld crowd = make_crowd(paper_scene(0));
    while (!crowd.active.empty() && crowd.steps < 30 * 60) take_steps(crowd, {}, 1);
    CHECK(crowd.arrived == 50);
    const double last = static_cast<double>(crowd.last_arrival_step) / 30;
    CHECK(last >= 38);
    CHECK(last <= 50);
}

TEST_CASE("People without bodies arrive by the same way at any rate of steps") {
    const auto lone_walk = [](double rate) {
        Scene scene = one_agent_scene(8, 3, 10, 18, 0);
        scene.frame_rate = scene.crowd->step_rate = rate;
        CrowdWorld crowd = make_crowd(scene);
        while (!crowd.active.empty() && static_cast<double>(crowd.steps) < 200 * rate) step(crowd, {});
        CHECK(crowd.arrived == 1);
        const double time = static_cast<double>(crowd.agents.end_step[0]) * crowd.dt - crowd.agents.end_before[0];
        return std::pair(crowd.agents.path_length[0], time);
    };
    const auto [path, time] = lone_walk(30);
    for (const double rate : {0.05, 0.1, 0.5, 1.0, 1.9, 2.0}) {
        CAPTURE(rate);
        // Markers bend the path every 1/30 s or 0.1 s: 10 % of its length. From 2 Hz on a step is whole: 0.5 s more.
        const auto [its_path, its_time] = lone_walk(rate);
        CHECK(its_path == Approx(path).epsilon(0.1));
        CHECK(its_time == Approx(time).epsilon(0.1).margin(0.5));
    }
}

TEST_CASE("Paths of agents with tau = 0 are the same bits whatever the water does") {
    CrowdWorld dry = make_crowd(paper_scene(0));
    CrowdWorld wet = make_crowd(paper_scene(0));
    const MadeUpWater torrent = uniform_water(0, 100, 0, 50, 1, 0.5, -7.3, 2.1);
    for (int i = 0; i < 200; ++i) {
        take_steps(dry, {}, 1);
        take_steps(wet, torrent, 1);
        REQUIRE(dry.agents.position == wet.agents.position);
    }
    CHECK(wet.agents.max_depth[0] > 0.9);  // the water was there
}

TEST_CASE("One agent in a uniform stream moves at the velocity of Eq. 9 in closed form", "[eq9]") {
    for (const ContactRule rule : {ContactRule::difference, ContactRule::sum}) {
        Scene scene = one_agent_scene(80, 25, 75, 50, 0.2);
        scene.coupling->contact_rule = rule;
        const double reach = rule == ContactRule::sum ? 0.75 : 0.25;
        const double v_f = -1.5;
        const double d = 0.25;
        const MadeUpWater stream = uniform_water(60, 95, 12, 38, 1, d, v_f, 0);
        CrowdWorld crowd = make_crowd(scene);
        for (int i = 0; i < 60; ++i) {
            // Its walk without water, from the same position.
            CrowdWorld dry = crowd;
            take_steps(dry, {}, 1);
            const Vector2d walking = dry.agents.velocity[0];

            const Vector2d p = crowd.agents.position[0];
            double water_mass = 0;
            for (std::size_t k = 0; k < stream.mass.size(); ++k) {
                const double dx = static_cast<double>(stream.px[k]) - p.x();
                const double dz = static_cast<double>(stream.pz[k]) - p.y();
                if (std::hypot(dx, dz) < reach) water_mass += 1000 * d * d * d;
            }
            REQUIRE(water_mass > 0);
            const double vx = (65 * walking.x() + 0.2 * water_mass * v_f) / (65 + 0.2 * water_mass);
            const double vz = 65 * walking.y() / (65 + 0.2 * water_mass);

            take_steps(crowd, stream, 1);
            const Vector2d v = (crowd.agents.position[0] - p) / crowd.dt;
            // 1e-5 m/s is asked for; float32 masses and velocities of the frame are exact here.
            REQUIRE(v.x() == Approx(vx).margin(1e-9));
            REQUIRE(v.y() == Approx(vz).margin(1e-9));
        }
    }
}

TEST_CASE("Whoever is carried over x = 0 is dead, whoever starts there is alive") {
    CrowdWorld crowd = make_crowd(one_agent_scene(0, 25, 75, 25, 1));
    take_steps(crowd, {}, 1);
    CHECK(crowd.agents.outcome[0] == Outcome::active);

    CrowdWorld swept = make_crowd(one_agent_scene(0.5, 25, 75, 25, 1));
    take_steps(swept, uniform_water(-2, 10, 20, 30, 1, 0.25, -6, 0), 10);
    CHECK(swept.agents.outcome[0] == Outcome::dead);
    CHECK(swept.agents.position[0].x() < 0);
    CHECK(swept.dead == 1);
    CHECK(swept.active.empty());
}

TEST_CASE("Nobody walks out of the world") {
    // The goals lie beyond the edges, far enough not to be reached.
    for (const Vector2d& goal : {Vector2d(-40, 25), Vector2d(140, 25), Vector2d(50, -40), Vector2d(50, 90)}) {
        const Vector2d start(goal.x() < 0     ? 1.0
                             : goal.x() > 100 ? 99.0
                                              : 50.0,
                             goal.y() < 0    ? 1.0
                             : goal.y() > 50 ? 49.0
                                             : 25.0);
        CrowdWorld crowd = make_crowd(one_agent_scene(start.x(), start.y(), goal.x(), goal.y(), 0.5));
        for (int i = 0; i < 150; ++i) {
            take_steps(crowd, {}, 1);
            const Vector2d& p = crowd.agents.position[0];
            REQUIRE((p.x() >= 0 && p.x() <= 100 && p.y() >= 0 && p.y() <= 50));
        }
        CHECK(crowd.agents.outcome[0] == Outcome::active);
    }
}

TEST_CASE("Water pushes nobody out of the world except over the fall") {
    CrowdWorld crowd = make_crowd(one_agent_scene(99.9, 49.9, 10, 10, 1));
    take_steps(crowd, uniform_water(90, 104, 40, 52, 1, 0.25, 8, 8), 30);
    CHECK(crowd.agents.outcome[0] == Outcome::active);
    CHECK(crowd.agents.position[0] == Vector2d(100, 50));
}

TEST_CASE("Dead and arrived agents give up their markers at once") {
    Scene scene = one_agent_scene(10, 25, 75, 25, 0);
    AgentGroup neighbour = scene.crowd->groups[0];
    neighbour.name = "neighbour";
    neighbour.start_x = 10.6;
    neighbour.goal_x = 10.7;
    neighbour.goal_z = 25;
    scene.crowd->groups.push_back(neighbour);
    CrowdWorld both = make_crowd(scene);
    scene.crowd->groups.pop_back();
    CrowdWorld alone = make_crowd(scene);
    take_steps(both, {}, 1);
    REQUIRE(both.agents.outcome[1] == Outcome::arrived);
    CHECK(both.agents.end_step[1] == 1);
    // From the same position, the first agent walks as it would without the other agent.
    alone.agents.position[0] = both.agents.position[0];
    alone.steps = 1;
    for (int i = 0; i < 20; ++i) {
        take_steps(both, {}, 1);
        take_steps(alone, {}, 1);
        REQUIRE(both.agents.position[0] == alone.agents.position[0]);
    }
    CHECK(both.agents.position[1] == both.agents.position[1]);
    CHECK(both.agents.end_step[1] == 1);
}

TEST_CASE("The order of the agents decides nothing but ties") {
    Scene scene = paper_scene(0);
    AgentGroup& group = scene.crowd->groups[0];
    CrowdWorld forward = make_crowd(scene);
    group.start_x = 87.5;
    group.pitch_x = -2.5;  // the same positions, ids reversed within each row
    CrowdWorld backward = make_crowd(scene);
    take_steps(forward, {}, 60);
    take_steps(backward, {}, 60);
    for (std::size_t row = 0; row < 5; ++row) {
        for (std::size_t column = 0; column < 10; ++column) {
            CHECK(forward.agents.position[10 * row + column] == backward.agents.position[10 * row + 9 - column]);
        }
    }
}

TEST_CASE("Events set tau of one agent, of a group and of all from their frame on") {
    Scene scene = paper_scene(0.8);
    AgentGroup second = scene.crowd->groups[0];
    second.name = "second";
    second.count = 2;
    second.start_x = 20;
    scene.crowd->groups.push_back(second);
    scene.events.push_back({5, std::nullopt, std::nullopt, 0});  // out of order on purpose
    scene.events.push_back({2, 7, std::nullopt, 0.1});
    scene.events.push_back({3, std::nullopt, "second", 0.3});
    CrowdWorld crowd = make_crowd(scene);
    take_steps(crowd, {}, 1);
    CHECK(crowd.agents.tau[7] == 0.8);
    take_steps(crowd, {}, 1);
    CHECK(crowd.agents.tau[7] == 0.1);
    CHECK(crowd.agents.tau[8] == 0.8);
    take_steps(crowd, {}, 1);
    CHECK(crowd.agents.tau[50] == 0.3);
    CHECK(crowd.agents.tau[49] == 0.8);
    take_steps(crowd, {}, 2);
    for (const double tau : crowd.agents.tau) CHECK(tau == 0);
}

TEST_CASE("Neither walking nor fast water takes an agent through an obstacle") {
    Scene scene = one_agent_scene(55, 25, 20, 25, 1);
    scene.obstacles.push_back({{40, 47}, {21.5, 28.5}, 1});
    AgentGroup& group = scene.crowd->groups[0];
    group.columns = 3;
    group.rows = 9;
    group.count = 27;
    group.start_x = 48;
    group.start_z = 21;  // two rows of the nine pass the corners, one starts exactly on the line of a face
    group.pitch_x = 1;
    group.pitch_z = 1;
    for (const double speed : {1.0, 30.0, 1000.0}) {
        CrowdWorld crowd = make_crowd(scene);
        const MadeUpWater jet = uniform_water(36, 56, 16, 34, 1, 0.25, -speed, 0.05 * speed);
        for (int i = 0; i < 60; ++i) {
            const std::vector<Vector2d> before = crowd.agents.position;
            take_steps(crowd, jet, 1);
            for (std::size_t id = 0; id < crowd.agents.size(); ++id) {
                const Vector2d& p = crowd.agents.position[id];
                REQUIRE_FALSE((40 < p.x() && p.x() < 47 && 21.5 < p.y() && p.y() < 28.5));
                // No agent before the block is behind it one frame later, unless it passes beside it.
                const bool before_it = before[id].x() >= 47 && before[id].y() > 21.5 && before[id].y() < 28.5;
                if (before_it && p.y() > 21.5 && p.y() < 28.5) REQUIRE(p.x() >= 47);
            }
        }
    }
}

TEST_CASE("Settings the crowd cannot work with are refused with the key") {
    Scene scene = one_agent_scene(10, 25, 75, 50, 0);
    scene.coupling->agent_radius = scene.coupling->particle_radius = 0.3;
    CHECK_THROWS_WITH(make_crowd(scene), Catch::Contains("/coupling"));
    scene.coupling->contact_rule = ContactRule::sum;
    CHECK_NOTHROW(make_crowd(scene));
    scene.coupling->agent_radius = 2;
    CHECK_THROWS_WITH(make_crowd(scene), Catch::Contains("contact distance 2.3 m"));

    scene = one_agent_scene(101, 25, 75, 50, 0);
    CHECK_THROWS_WITH(make_crowd(scene), Catch::Contains("/crowd/groups/0") && Catch::Contains("outside the world"));
    scene = one_agent_scene(45, 25, 75, 50, 0);
    scene.obstacles.push_back({{40, 50}, {20, 30}, 1});
    CHECK_THROWS_WITH(make_crowd(scene), Catch::Contains("inside an obstacle"));
}

namespace {

Scene empty_ground(std::uint64_t seed, double rate) {
    Scene scene;
    scene.seed = seed;
    scene.frame_rate = scene.crowd->step_rate = rate;
    scene.world = {.length = 40, .width = 40};
    scene.channel->x = scene.channel->z = {0, 40};
    scene.channel->flow = Flow::closed;
    scene.crowd->markers = MarkerRule::redrawn;
    scene.crowd->goal_radius = 0.5;
    return scene;
}

void add_walker(Scene& scene, const Vector2d& from, const Vector2d& to, double speed) {
    AgentGroup group;
    group.name = "walker" + std::to_string(scene.crowd->groups.size());
    group.start_x = from.x();
    group.start_z = from.y();
    group.goal_x = to.x();
    group.goal_z = to.y();
    group.desired_speed = speed;
    scene.crowd->groups.push_back(group);
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
        scene.crowd->markers_per_cell = markers;
        add_walker(scene, {15, z}, {25, z}, 1.3);
        add_walker(scene, {25, z}, {15, z}, 1.3);
        add_walker(scene, {26, z}, {15, z}, 1.3);
        INFO("seed " << seed << ", " << markers << " markers, z " << z);
        CHECK(time_to_pass(scene) < 14);
    }
}

TEST_CASE("Redrawn markers of points are in the mean everywhere alike, those of bodies keep to their sub-cells") {
    Scene scene = empty_ground(3, 30);
    scene.crowd->bodies = GENERATE(BodyRule::none, BodyRule::fast);
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
    if (scene.crowd->bodies == BodyRule::none) {
        // The markers of an epoch move together, so that a strip has 400 independent values: two strips in five empty in
        // each, its mean is known to 4 % of itself. Five times that.
        CHECK(*least > 0.8 * mean);
        CHECK(*most < 1.2 * mean);
    } else {
        CHECK(*least == 0);
    }
}
