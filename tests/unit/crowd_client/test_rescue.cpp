// Rescuers of a crowd and the people that they rescue, in even streams.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <utility>
#include <vector>

#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/hands.hpp"
#include "crowd_client/rescue.hpp"
#include "made_up_water.hpp"

namespace wade::crowd::rescue_test {

using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::one_agent_scene;
using wade::crowd::testing::uniform_water;

// From z 15 m to the other bank.
MadeUpWater stream_to(double bank, double speed, double depth) {
    MadeUpWater water = uniform_water(20, 62, 15, bank, 0.25, 0.25, -speed, 0);
    for (float& of_one : water.mass) of_one *= static_cast<float>(4 * depth);
    return water;
}

MadeUpWater stream(double speed, double depth) {
    return stream_to(40, speed, depth);
}

// One falls in the middle of the stream, in 1.2 m of water from z 15 m on; rescuers wait on the bank.
Scene with_rescuers(double start_x, double start_z) {
    Scene scene = one_agent_scene(55, 20, 45, 5, 1);
    scene.fluid->particle_spacing = 0.25;
    scene.crowd->response = ResponseKind::measured;
    scene.crowd->goal_radius = 1;
    AgentGroup& victim = scene.crowd->groups[0];
    victim.tau.reset();
    victim.body.sex = SexRule::male;
    victim.body.skill = Skill::unaware;
    scene.crowd->groups.push_back(victim);
    AgentGroup& rescuers = scene.crowd->groups[1];
    rescuers.name = "rescuers";
    rescuers.rescuer = true;
    rescuers.start_x = rescuers.goal_x = start_x;
    rescuers.start_z = rescuers.goal_z = start_z;
    rescuers.desired_speed = 1.3;
    rescuers.body.skill = Skill::good;
    return scene;
}

TEST_CASE("A rescuer on the bank throws a line, and the stream swings whom it holds to the bank") {
    const Scene scene = with_rescuers(45, 13);
    const MadeUpWater water = stream(0.7, 1.2);
    CrowdWorld crowd = make_crowd(scene);
    bool threw = false;
    for (int i = 0; i < 90 * 30 && !crowd.active.empty(); ++i) {
        step(crowd, water.view());
        threw = threw || (!crowd.links.empty() && crowd.links[0].kind == LinkKind::line);
        REQUIRE(has_ground(crowd.agents.people.condition[1].state));
    }
    CHECK(threw);
    const RescueCount count = count_rescues(crowd);
    CHECK(count.rescuers == 1);
    CHECK(count.saved == 1);
    CHECK(count.lost_feet == 0);
    CHECK(crowd.arrived == 2);  // the rescuer last, at its goal
    CHECK(crowd.agents.end_step[1] >= crowd.agents.end_step[0]);
}

TEST_CASE("A rescuer goes into water in which it stands well, no farther, and not behind a wall") {
    const auto deepest_met = [](Skill skill, double speed, bool walled) {
        Scene scene = with_rescuers(45, 13);
        scene.crowd->groups[0].start_z = 32;
        scene.crowd->groups[0].goal_z = 45;
        scene.crowd->groups[1].body.skill = skill;
        if (walled) scene.obstacles.push_back({{0, scene.world->length}, {28, 28.5}, 3});
        CrowdWorld crowd = make_crowd(scene);
        const MadeUpWater water = stream(speed, 1.05);
        for (int i = 0; i < 25 * 30; ++i) step(crowd, water.view());
        return crowd.agents.max_depth[1];
    };
    CHECK(deepest_met(Skill::braced, 0.62, false) > 0.9);
    CHECK(deepest_met(Skill::braced, 0.62, true) == 0);
    CHECK(deepest_met(Skill::poor, 0.62, false) == 0);
}

// A person holds on to a post at x 42 in the stream; the house occludes it for the rescuer on the bank.
Scene with_house(Skill of_rescuer, std::vector<Obstacle> obstacles) {
    Scene scene = with_rescuers(45, 13);
    scene.crowd->navigation.rule = NavigationRule::automatic;
    scene.crowd->groups[0].start_x = 48;
    scene.crowd->groups[0].start_z = 29;
    scene.crowd->groups[0].goal_z = 45;
    scene.crowd->groups[1].body.skill = of_rescuer;
    Rope& post = scene.crowd->ropes.emplace_back();
    post.from_x = 42;
    post.from_z = 29.3;
    post.free_length = 0;
    scene.obstacles = std::move(obstacles);
    return scene;
}

struct RescuePath {
    std::vector<Vector2d> places;
    bool entered = false;  // an obstacle
    RescueCount count;
};

RescuePath rescue_in(const Scene& scene, double time) {
    CrowdWorld crowd = make_crowd(scene);
    const MadeUpWater water = stream_to(32, 0.62, 1.05);
    RescuePath path;
    for (int i = 0; i < time * 30; ++i) {
        step(crowd, water.view());
        const Vector2d& place = crowd.agents.position[1];
        path.places.push_back(place);
        for (const Obstacle& box : scene.obstacles) {
            path.entered = path.entered || (box.x.contains(place.x()) && box.z.contains(place.y()));
        }
    }
    path.count = count_rescues(crowd);
    return path;
}

TEST_CASE("A rescuer walks round a house to whom it cannot see, and does not set out where there is no way") {
    const Obstacle house{{36, 52}, {22, 24}, 3};
    const RescuePath round = rescue_in(with_house(Skill::braced, {house}), 90);
    CHECK(round.count.saved == 1);
    CHECK(round.count.lost_feet == 0);
    CHECK(!round.entered);

    const auto sets_out = [](const RescuePath& path) {
        return std::any_of(path.places.begin(), path.places.end(),
                           [&](const Vector2d& place) { return (place - path.places.front()).squaredNorm() > 1; });
    };
    CHECK(sets_out(round));
    CHECK(!sets_out(rescue_in(with_house(Skill::braced, {{{0, 100}, {22, 24}, 3}}), 20)));
    CHECK(!sets_out(rescue_in(with_house(Skill::poor, {house}), 20)));  // would lose its footing on the route
    Scene straight = with_house(Skill::braced, {house});
    straight.crowd->navigation.rule = NavigationRule::straight;
    CHECK(!sets_out(rescue_in(straight, 20)));
}

TEST_CASE("Where nothing is in the way a house beside it changes no bit of what a rescuer does") {
    Scene scene = with_house(Skill::braced, {{{80, 84}, {30, 34}, 3}});
    const std::vector<Vector2d> led = rescue_in(scene, 20).places;
    scene.crowd->navigation.rule = NavigationRule::straight;
    CHECK(rescue_in(scene, 20).places == led);
}

TEST_CASE("A rescuer who loses the feet drops the line and counts as a victim") {
    CrowdWorld crowd = make_crowd(with_rescuers(45, 13));
    const MadeUpWater water = stream(0.7, 1.2);
    for (int i = 0; i < 10 * 30 && crowd.links.empty(); ++i) step(crowd, water.view());
    REQUIRE(crowd.links.size() == 1);
    crowd.agents.people.condition[1].state = PersonState::toppled;
    step(crowd, water.view());
    CHECK(crowd.links.empty());
    CHECK(count_rescues(crowd).lost_feet == 1);
    CHECK(count_rescues(crowd).saved == 0);
}

// On the bank, where nothing but the ground and the line T e act: M dv/dt = G + T e, G what the legs want, at most mu M g.
TEST_CASE("Whom its feet do not hold its line drags into the stream, by the equation of all, and it is swept off") {
    Scene scene = with_rescuers(45, 14);
    scene.crowd->groups[1].body.skill = Skill::poor;
    CrowdWorld crowd = make_crowd(scene);
    const MadeUpWater water = stream(0.7, 1.2);
    const double mass = crowd.agents.mass[1], most = 0.07 * mass * scene.world->gravity, dt = crowd.dt;
    int pulled = 0;
    double error = 0;  // of the velocity, m/s
    for (int i = 0; i < 60 * 30 && has_ground(crowd.agents.people.condition[1].state); ++i) {
        const Vector2d before = crowd.agents.momentary[1], place = crowd.agents.position[1];
        const Vector2d along = unit_or(way_to(crowd, 1, crowd.agents.position[0]), Vector2d::Zero());
        const bool held = !crowd.links.empty();
        step(crowd, water.view());
        if (!held || crowd.links.empty() || crowd.agents.people.depth[1] > 0 || place.y() > 14.4) continue;
        const Vector2d pull = crowd.links[0].pull * along;
        const Vector2d wanted = mass / dt * (std::exp(-dt / 0.4) - 1) * before - pull;
        const double force = std::sqrt(wanted.squaredNorm());
        const Vector2d legs = wanted * std::min(1.0, most / force);
        const Vector2d next = before + dt / mass * (legs + pull);
        error = std::max(error, std::sqrt((crowd.agents.momentary[1] - next).squaredNorm()));
        pulled += crowd.links[0].pull > most ? 1 : 0;
    }
    CHECK(pulled > 5);
    CHECK(error < 1e-3);  // a round of the solution by people in turn
    CHECK(crowd.agents.position[1].y() > 15);
    CHECK(crowd.agents.people.condition[1].state == PersonState::toppled);
    for (int i = 0; i < 15 * 30; ++i) {
        step(crowd, water.view());
        REQUIRE(crowd.links.empty());  // a rescuer that sits in the water throws no line
    }
    CHECK(!is_firm(crowd.agents.people.condition[1].state));
    CHECK(crowd.agents.position[1].x() < 40);
    CHECK(count_rescues(crowd).lost_feet == 1);

    scene.crowd->groups[1].body.skill = Skill::good;  // holds 408 N
    CrowdWorld firm = make_crowd(scene);
    for (int i = 0; i < 20 * 30; ++i) step(firm, water.view());
    CHECK(firm.agents.position[1].y() == Approx(14).margin(0.01));
    CHECK(count_rescues(firm).lost_feet == 0);
}

}  // namespace wade::crowd::rescue_test
