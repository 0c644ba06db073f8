// The crowd records agents that stand although they want to move, and the cause; start warnings name it if known.

#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/crowd.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/standing.hpp"
#include "crowd_client/start_warnings.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using namespace wade::crowd::testing;

namespace {

constexpr double world_length = 60, world_width = 40;  // of the world, m

AgentGroup& add_group(Scene& scene, int columns, Vector2d start, Vector2d goal, double pitch = 1) {
    AgentGroup group = row_of_people(columns, start, pitch, goal);
    group.name = "group" + std::to_string(scene.crowd->groups.size());
    scene.crowd->groups.push_back(group);
    return scene.crowd->groups.back();
}

CrowdWorld walked(const Scene& scene, double time, const MadeUpWater& water = {}) {
    CrowdWorld crowd = make_crowd(scene);
    while (static_cast<double>(crowd.steps) * crowd.dt < time - 1e-9) step(crowd, water.view());
    return crowd;
}

// Mean progress of lone walkers over their desired speed.
double progress(const Scene& base) {
    double sum = 0;
    constexpr int seeds = 4, walkers = 7;
    for (int seed = 1; seed <= seeds; ++seed) {
        Scene scene = base;
        scene.seed = static_cast<std::uint64_t>(seed);
        for (int i = 0; i < walkers; ++i) add_group(scene, 1, {10, 5 + 5.1 * i}, {55, 5.8 + 5.1 * i});
        for (const Vector2d& p : walked(scene, 20).agents.position) sum += (p.x() - 10) / 20 / 1.3;
    }
    return sum / (seeds * walkers);
}

Scene before_a_house(NavigationRule rule) {
    Scene scene = dry_scene(world_length, world_width, {{{20, 30}, {20, 24}, 3}});
    scene.crowd->navigation.rule = rule;
    add_group(scene, 3, {24, 15}, {25, 30});
    return scene;
}

}  // namespace

TEST_CASE("Who gets no farther than a twentieth of the free way in 30 s stands, and walks again once it does") {
    Scene scene = before_a_house(NavigationRule::straight);
    CrowdWorld crowd = make_crowd(scene);
    while (crowd.steps < 300) {
        CHECK(count_standing(crowd) == 0);
        step(crowd, {});
    }
    while (crowd.steps < 400) step(crowd, {});
    REQUIRE(count_standing(crowd) == 3);
    CHECK(state_name(crowd, 0) == "standing");
    CHECK(crowd.active.size() == 3);
    REQUIRE(crowd.warnings.size() == 1);
    CHECK_THAT(crowd.warnings[0], Catch::Contains("3 people stand") && Catch::Contains("agent 0 at (") &&
                                      Catch::Contains("obstacle") &&
                                      Catch::Contains("/crowd/navigation/rule \"auto\""));
    for (Vector2d& goal : crowd.agents.goal) goal = {5, 10};
    for (int k = 0; k < 60; ++k) step(crowd, {});
    CHECK(count_standing(crowd) == 0);
    CHECK(state_name(crowd, 0) == "walking");
    CHECK(crowd.warnings.size() == 1);
}

TEST_CASE("Walkers, those who want nothing and those who have arrived do not stand, at any rate of the steps") {
    const double rate = GENERATE(0.5, 7.0, 30.0);
    Scene scene = dry_scene(world_length, world_width);
    scene.frame_rate = scene.crowd->step_rate = rate;
    add_group(scene, 3, {5, 5}, {55, 35});
    add_group(scene, 2, {5, 30}, {55, 35}).desired_speed = 0;
    add_group(scene, 2, {20, 30}, {21, 30}).desired_speed = 0.05;  // a slow one
    const CrowdWorld crowd = walked(scene, 60);
    CHECK(count_standing(crowd) == 0);
    CHECK(crowd.warnings.empty());
    CHECK(state_name(crowd, 0) == (crowd.arrived > 1 ? "arrived" : "walking"));
}

TEST_CASE("A warning names what keeps people, and the key that helps") {
    Scene scene = dry_scene(world_length, world_width);
    std::vector<std::string> words;
    SECTION("water") {
        scene.channel->flow = Flow::recirculating;
        add_group(scene, 1, {20, 20}, {50, 20}).tau = 1;
        scene.obstacles = {{{18, 19}, {0, 40}, 3}};
        words = {"the water", "/crowd/tau"};
    }
    SECTION("people") {
        scene.crowd->bodies = BodyRule::fast;
        add_group(scene, 1, {20, 20}, {50, 20});
        // A ring of people without a desired speed.
        for (int i = 0; i < 12; ++i) {
            const double a = 6.283185307179586 * i / 12;
            add_group(scene, 1, {20 + 1.05 * std::cos(a), 20 + 1.05 * std::sin(a)}, {50, 20}).desired_speed = 0;
        }
        words = {"people are before them", "/crowd/markers \"redrawn\""};
    }
    SECTION("no way") {
        scene.obstacles = {{{30, 31}, {0, 40}, 3}};
        add_group(scene, 2, {25, 20}, {50, 20});
        words = {"no way that they fit through", "/crowd/body_radius_m"};
    }
    SECTION("markers") {
        scene.crowd->markers_per_cell = 2;
        add_group(scene, 2, {25, 20}, {50, 20});
        words = {"too few markers", "/crowd/markers_per_cell to 45"};
    }
    const MadeUpWater stream = uniform_water(0, 60, 0, 40, 1, 0.5, -2, 0);
    const CrowdWorld crowd = walked(scene, 45, scene.channel->flow == Flow::closed ? MadeUpWater() : stream);
    REQUIRE(count_standing(crowd) > 0);
    REQUIRE_FALSE(crowd.warnings.empty());
    for (const std::string& word : words) CHECK_THAT(crowd.warnings.back(), Catch::Contains(word));
}

TEST_CASE("With the least number of markers people walk, with half of it they do not, and this is said at the start") {
    Scene scene = dry_scene(world_length, world_width);
    scene.crowd->markers = GENERATE(MarkerRule::fixed, MarkerRule::redrawn);
    scene.crowd->bodies = GENERATE(BodyRule::none, BodyRule::fast);
    scene.crowd->perception_radius = GENERATE(1.0, 2.0);
    const int least = least_markers_per_cell(scene.crowd);
    const bool redrawn = scene.crowd->markers == MarkerRule::redrawn;
    const auto square_from = [&](int n) { return static_cast<int>(std::pow(std::ceil(std::sqrt(n)), 2)); };
    INFO(least << " markers, redrawn " << redrawn << ", R " << scene.crowd->perception_radius);
    // 28 walks; 0.05 is twice their scatter.
    scene.crowd->markers_per_cell = redrawn ? square_from(least) : least;
    CHECK(progress(scene) > 0.9 - 0.05);
    add_group(scene, 1, {5, 5}, {50, 5});
    CHECK(make_crowd(scene).warnings.empty());
    scene.crowd->groups.clear();
    scene.crowd->markers_per_cell = redrawn ? square_from(least / 4) : least / 2;
    CHECK(progress(scene) < 0.9);
    add_group(scene, 1, {5, 5}, {50, 5});
    const CrowdWorld crowd = make_crowd(scene);
    REQUIRE(crowd.warnings.size() == 1);
    CHECK_THAT(crowd.warnings[0], Catch::Contains("/crowd/markers_per_cell") && Catch::Contains(std::to_string(least)));
}

TEST_CASE("Goals that nobody gets to are said at the start, whatever the navigation") {
    // A yard; a door into it that is wide enough for a body, or not even for one that turns its shoulders, or none.
    const double door = GENERATE(0.0, 0.3, 0.9);
    const BodyRule bodies = GENERATE(BodyRule::none, BodyRule::human);
    const NavigationRule rule =
        GENERATE(NavigationRule::automatic, NavigationRule::straight, NavigationRule::travel_time);
    Scene scene = dry_scene(world_length, world_width,
                            {{{30, 31}, {10, 20 - door / 2}, 3},
                             {{30, 31}, {20 + door / 2, 30}, 3},
                             {{40, 41}, {10, 30}, 3},
                             {{31, 40}, {10, 11}, 3},
                             {{31, 40}, {29, 30}, 3}});
    if (door == 0) scene.obstacles[1].z.lo = 20;
    scene.crowd->bodies = bodies;
    scene.crowd->markers = MarkerRule::redrawn;
    scene.crowd->navigation.rule = rule;
    add_group(scene, 2, {10, 5}, {35, 20});
    INFO("door of " << door << " m");
    if (door > 0.5) {
        CHECK(make_crowd(scene).warnings.empty());
        return;
    }
    const bool refused =
        rule == NavigationRule::travel_time || (rule == NavigationRule::automatic && bodies != BodyRule::none);
    std::string said;
    try {
        const std::vector<std::string> warnings = make_crowd(scene).warnings;
        REQUIRE(warnings.size() == 1);
        said = warnings[0];
        CHECK_FALSE(refused);
    } catch (const ConfigurationError& error) {
        said = error.what();
        CHECK(refused);
    }
    for (const char* words : {"/crowd/groups/0", "without a way", "as do 1 more", "/crowd/body_radius_m"}) {
        CHECK_THAT(said, Catch::Contains(words));
    }
}
