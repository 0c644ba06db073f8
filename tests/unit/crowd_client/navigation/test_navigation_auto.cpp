// Automatic navigation, the default: a travel-time field only if an obstacle stands between an agent and its goal.

#include <catch2/catch.hpp>
#include <cmath>
#include <utility>
#include <vector>

#include "configs/loading/scene_loader.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/markers/counter_random.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using namespace wade::crowd::testing;

namespace {

// Four people, three of them before a box.
Scene one_box() {
    Scene scene = dry_scene(20, 20, {{{5, 11}, {5, 8}, 3}});
    scene.crowd->groups = {row_of_people(4, {4, 2}, 1, {12, 14})};
    return scene;
}

// Eleven people before a house.
Scene house() {
    Scene scene = dry_scene(40, 30, {{{15, 23}, {10, 18}, 3}});
    scene.crowd->groups = {row_of_people(11, {10, 2}, 2, {20, 28})};
    return scene;
}

// The paper's village, or a periodic lap of it, without its water.
Scene village(Ends ends) {
    Scene scene = load_scene(WADE_SCENES "/paper/village.json").scene;
    scene.world->ends = ends;
    scene.crowd->navigation.rule = NavigationRule::automatic;
    scene.frame_rate = scene.crowd->step_rate = 10;
    return scene;
}

// A wall with a door that only fine cells resolve, and a far longer route round the wall.
Scene door(double width) {
    Scene scene = dry_scene(20, 30, {{{10, 10.2}, {0, 3 - width / 2}, 3}, {{10, 10.2}, {3 + width / 2, 25}, 3}});
    scene.crowd->groups = {row_of_people(3, {3, 6}, 1, {17, 6.2})};
    return scene;
}

CrowdWorld walked(const Scene& scene, double time) {
    CrowdWorld crowd = make_crowd(scene);
    while (!crowd.active.empty() && static_cast<double>(crowd.steps) * crowd.dt < time) step(crowd, {});
    return crowd;
}

}  // namespace

TEST_CASE("With the default rule nobody stands before a house") {
    Scene scene = GENERATE(one_box(), house(), village(Ends::open), village(Ends::periodic));
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        scene.seed = seed;
        CHECK(walked(scene, 120).arrived == make_agents(scene).size());
    }
}

TEST_CASE("With the default rule people find a narrow door, and what bodies do not fit through is no door") {
    for (const double width : {0.62, 0.7, 0.9, 1.3}) {
        const CrowdWorld crowd = walked(door(width), 60);
        INFO("door of " << width << " m");
        REQUIRE(crowd.arrived == 3);
        for (const double length : crowd.agents.path_length) CHECK(length < 20);
    }
    Scene scene = door(0.34);  // shoulders turned, bodies need 0.36 m
    scene.crowd->bodies = BodyRule::fast;
    scene.crowd->markers = MarkerRule::redrawn;
    const CrowdWorld round = walked(scene, 60);
    REQUIRE(round.arrived == 3);
    for (const double length : round.agents.path_length) CHECK(length > 40);
}

TEST_CASE(
    "With the default rule there is no field where no obstacle is in the way, and the bits are those of straight") {
    Scene scene = dry_scene(40, 20, {{{18, 20}, {0, 6}, 3}, {{18, 20}, {14, 20}, 3}});
    scene.crowd->groups = {row_of_people(8, {2, 10}, 1, {38, 10})};
    CrowdWorld crowd = make_crowd(scene);
    scene.crowd->navigation.rule = NavigationRule::straight;
    CrowdWorld straight = make_crowd(scene);
    while (!straight.active.empty()) {
        step(crowd, {});
        step(straight, {});
        REQUIRE(crowd.agents.position == straight.agents.position);
    }
    CHECK(crowd.navigation.solved == 0);
    CHECK(crowd.navigation.grid.closed.empty());
}

TEST_CASE("Fields are made for the goals that somebody does not see, and for no others") {
    Scene scene = house();
    AgentGroup beside = row_of_people(2, {30, 2}, 2, {32, 28});
    beside.name = "beside";
    scene.crowd->groups.push_back(beside);
    const CrowdWorld crowd = make_crowd(scene);
    REQUIRE(crowd.navigation.fields.size() == 2);
    CHECK(crowd.navigation.fields[0].is_solved());
    CHECK_FALSE(crowd.navigation.fields[1].is_solved());
    CHECK(crowd.navigation.solved == 1);
}

TEST_CASE("Ways are looked for every 0.1 s at any rate of steps, and kept in between") {
    const auto [rate, decisions] =
        GENERATE(std::pair{30.0, 3}, std::pair{60.0, 6}, std::pair{10.0, 1}, std::pair{2.0, 1});
    Scene scene = house();
    scene.frame_rate = scene.crowd->step_rate = rate;
    CrowdWorld crowd = make_crowd(scene);
    REQUIRE(crowd.navigation.solved == 1);
    // All people stand at one position, farther on in each decision.
    const auto way_at = [&](int place, int decision) {
        const Vector2d p(17 + 0.3 * place, 6);
        const std::vector<Vector2d> at(crowd.active.size(), p);
        std::vector<Vector2d> ways(at.size(), Vector2d(20, 28) - p);
        steer(crowd.navigation, crowd.active, at, ways, static_cast<std::uint64_t>(decision), 1);
        return ways.front();
    };
    std::vector<Vector2d> looks;
    for (int k = 0; k < 2 * decisions; ++k) looks.push_back(way_at(k, 0));
    for (int k = 0; k < 2 * decisions; ++k) {
        CAPTURE(rate, k);
        CHECK(way_at(k, k) == looks[static_cast<std::size_t>(k - k % decisions)]);
        CHECK((k == 0 || looks[static_cast<std::size_t>(k)] != looks[static_cast<std::size_t>(k - 1)]));
    }
}

TEST_CASE("Who is pushed behind a house finds round it, with the same bits for any number of threads") {
    Scene scene = dry_scene(60, 30, {{{10, 20}, {12, 18}, 3}});
    scene.channel->flow = Flow::recirculating;
    AgentGroup group = row_of_people(20, {26, 2}, 0.7, {30, 28});
    group.rows = 60;
    group.count = 1200;
    group.pitch_z = 0.08;
    group.tau = 1;
    scene.crowd->groups = {group};
    scene.crowd->markers = MarkerRule::redrawn;
    std::vector<CrowdWorld> crowds;
    for (const int threads : {1, 3}) {
        CrowdWorld crowd = make_crowd(scene);
        crowd.threads = threads;
        CHECK(crowd.navigation.solved == 0);
        const MadeUpWater stream = uniform_water(0, 60, 0, 12, 1, 0.5, -3, 0);
        for (int i = 0; i < 45; ++i) step(crowd, stream.view());
        for (int i = 0; i < 15; ++i) step(crowd, {});
        CHECK(crowd.navigation.solved == 1);
        crowds.push_back(crowd);
    }
    CHECK(crowds[0].agents.position == crowds[1].agents.position);
    while (!crowds[0].active.empty() && crowds[0].steps < 1500) step(crowds[0], {});
    CHECK(crowds[0].arrived == 1200);
}

TEST_CASE("With the default rule somebody without a way walks as near as it gets, and crowding asks for fields") {
    Scene scene = dry_scene(20, 20, {{{10, 11}, {0, 20}, 3}});
    scene.crowd->groups = {row_of_people(1, {3, 10}, 1, {17, 10})};
    const CrowdWorld crowd = walked(scene, 30);
    CHECK(crowd.arrived == 0);
    CHECK(crowd.agents.position[0].x() > 9.5);
    scene.obstacles.clear();
    scene.crowd->navigation.crowding = 1;
    CHECK(make_crowd(scene).navigation.solved == 1);
}
