// People of a crowd who hold one another, in even streams.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "crowd_client/crowd_world.hpp"
#include "crowd_client/hands.hpp"
#include "crowd_client/rescue.hpp"
#include "made_up_water.hpp"

namespace wade::crowd::hands_test {

using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::one_agent_scene;
using wade::crowd::testing::uniform_water;

MadeUpWater stream(double speed, double depth = 1, double bank = 40) {
    MadeUpWater water = uniform_water(20, 62, 15, bank, 0.25, 0.25, -speed, 0);
    for (float& of_one : water.mass) of_one *= static_cast<float>(4 * depth);
    return water;
}

// `count` men of normal skill stand side by side across the stream.
Scene side_by_side(int count, HandInHand hands) {
    Scene scene = one_agent_scene(50, 25, 50, 25, 0);
    scene.fluid.particle_spacing = 0.25;
    scene.crowd.response = ResponseKind::measured;
    scene.crowd.goal_radius = 1e-9;
    AgentGroup& group = scene.crowd.groups[0];
    group.tau.reset();
    group.desired_speed = 0;
    group.body.sex = SexRule::male;
    group.rows = group.count = count;
    group.pitch_z = 0.7;
    group.hand_in_hand = hands;
    group.goal_x = 60;
    return scene;
}

// How many lose their feet within a time.
std::size_t fallen(const Scene& scene, const MadeUpWater& water, double time) {
    CrowdWorld crowd = make_crowd(scene);
    std::set<std::size_t> ids;
    for (int i = 0; i < time * scene.crowd.step_rate; ++i) {
        step(crowd, water.view());
        for (std::size_t id = 0; id < crowd.agents.size(); ++id) {
            if (!has_ground(crowd.agents.people.condition[id].state)) ids.insert(id);
        }
    }
    return ids.size();
}

TEST_CASE("Links of a group join neighbours of its start grid, along x or along z") {
    Scene scene = side_by_side(5, HandInHand::along_z);
    scene.crowd.groups.push_back(scene.crowd.groups[0]);
    AgentGroup& group = scene.crowd.groups[1];
    group.start_x = 40;
    group.columns = 3;
    group.rows = 2;
    group.count = 5;
    group.pitch_x = 0.7;
    group.hand_in_hand = HandInHand::along_x;
    group.hold = Hold::arms;
    const CrowdWorld crowd = make_crowd(scene);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const Link& link : crowd.links) pairs.emplace_back(link.a, link.b);
    CHECK(pairs ==
          std::vector<std::pair<std::uint32_t, std::uint32_t>>{{0, 1}, {1, 2}, {2, 3}, {3, 4}, {5, 6}, {6, 7}, {8, 9}});
    CHECK(!crowd.links[0].pushes);
    CHECK(crowd.links[4].pushes);
    CHECK(crowd.links[0].grip == grip_of_men);
    scene.crowd.groups[1].body.sex = SexRule::female;
    CHECK(make_crowd(scene).links[4].grip == grip_of_women);
}

// Alone one topples at 0.874 m/s and slides at 1.060 m/s, in 1 m of water.
TEST_CASE("Hand in hand people stand in a stream that topples each alone, until they slide") {
    CHECK(fallen(side_by_side(3, HandInHand::none), stream(0.97), 5) == 3);
    CHECK(fallen(side_by_side(3, HandInHand::along_z), stream(0.97), 5) == 0);
    CHECK(fallen(side_by_side(3, HandInHand::along_z), stream(0.80), 5) == 0);
}

TEST_CASE("Whoever is carried past is held by who stands, and is carried on where nobody helps") {
    Scene scene = side_by_side(1, HandInHand::none);
    scene.crowd.groups[0].start_x = 50;
    scene.crowd.groups[0].body.skill = Skill::unaware;
    scene.crowd.groups.push_back(scene.crowd.groups[0]);
    AgentGroup& helper = scene.crowd.groups[1];
    helper.name = "helper";
    helper.start_x = 45;
    helper.start_z = 25.3;
    helper.body.skill = Skill::braced;
    helper.body.ground_friction = 2;
    const MadeUpWater water = stream(0.6, 1.2);
    for (const bool helping : {false, true}) {
        scene.crowd.helping = helping;
        CrowdWorld crowd = make_crowd(scene);
        for (int i = 0; i < 25 * 30; ++i) step(crowd, water.view());
        CAPTURE(helping);
        CHECK(has_ground(crowd.agents.people.condition[1].state));
        CHECK((crowd.agents.people.condition[0].state == PersonState::holding) == helping);
        CHECK((crowd.agents.position[0].x() < 42) == !helping);
        CHECK(crowd.links.size() == (helping ? 1 : 0));
    }
}

// A hand that bears a share of its grip bears it for the endurance time of a hand, then lets go.
TEST_CASE("Who holds somebody in the stream lets go when the hand is tired, at any rate of steps") {
    Scene scene = side_by_side(1, HandInHand::none);
    scene.crowd.helping = scene.crowd.fatigue = true;
    scene.crowd.groups[0].body.skill = Skill::unaware;
    scene.crowd.groups.push_back(scene.crowd.groups[0]);
    AgentGroup& helper = scene.crowd.groups[1];
    helper.name = "helper";
    helper.start_x = 45;
    helper.start_z = 25.3;
    helper.body.skill = Skill::braced;
    helper.body.ground_friction = 2;
    MadeUpWater water = uniform_water(28, 56, 18, 32, 0.5, 0.5, -0.7, 0);
    for (float& of_one : water.mass) of_one *= 2.4F;  // 1.2 m
    std::vector<double> times;
    for (const double rate : {15.0, 60.0}) {
        scene.crowd.step_rate = scene.frame_rate = rate;
        CrowdWorld crowd = make_crowd(scene);
        double taken = 0, let_go = 0, load = 0;
        for (int i = 1; i <= 100 * rate && let_go == 0; ++i) {
            step(crowd, water.view());
            if (taken == 0 && !crowd.links.empty()) taken = i / rate;
            if (taken > 0 && i / rate < taken + 10 && !crowd.links.empty()) load = crowd.links[0].pull / grip_of_men;
            if (taken > 0 && crowd.links.empty()) let_go = i / rate;
        }
        CAPTURE(rate, taken, load);
        CHECK((load > 0.5 && load < 0.7));
        CHECK(let_go - taken ==
              Approx(endurance_time(load, hand_rates) + 0.3).epsilon(0.05));  // the first pull differs
        times.push_back(let_go - taken);
    }
    CHECK(times[0] == Approx(times[1]).epsilon(0.02));
}

// A rope with a free end, a post if its length is 0.
Rope rope_from(double x, double z, double length) {
    Rope rope;
    rope.from_x = x;
    rope.from_z = z;
    rope.free_length = length;
    return rope;
}

// One across the stream, at x.
Rope rope_across(double x) {
    Rope rope = rope_from(x, 20, 0);
    rope.free_length.reset();
    rope.to_x = x;
    rope.to_z = 30;
    return rope;
}

// One who falls at x 50 and is carried off in 1.2 m of water.
Scene one_carried() {
    Scene scene = side_by_side(1, HandInHand::none);
    scene.crowd.groups[0].body.skill = Skill::unaware;
    return scene;
}

TEST_CASE("Ropes across the stream, with a free end and posts hold whom a stream carries past, but no strong one") {
    const auto x_after = [&](const Rope& rope, double speed) {
        Scene scene = one_carried();
        scene.crowd.ropes = {rope};
        CrowdWorld crowd = make_crowd(scene);
        const MadeUpWater water = stream(speed, 1.2);
        for (int i = 0; i < 30 * 20 / speed; ++i) step(crowd, water.view());
        const bool holds = crowd.agents.people.condition[0].state == PersonState::holding;
        CHECK(holds == !crowd.links.empty());
        if (holds) CHECK(crowd.links[0].pull == Approx(275 * speed * speed).epsilon(0.02));
        return crowd.agents.position[0].x();
    };
    CHECK(x_after(rope_across(42), 0.8) == Approx(41.2).margin(0.15));
    CHECK(x_after(rope_from(42, 25.3, 0), 0.8) == Approx(41.2).margin(0.2));
    CHECK(x_after(rope_from(44, 25.6, 4), 0.8) > 39);
    CHECK(x_after(rope_from(42, 26.5, 0), 0.8) < 40);
    CHECK(x_after(rope_across(42), 1.4) < 39);
    CHECK(x_after(rope_from(44, 25.6, 4), 1.4) < 38);
}

TEST_CASE("Along a rope one crosses a stream that topples one without it, and leaves the rope at will") {
    Scene scene = side_by_side(1, HandInHand::none);
    AgentGroup& group = scene.crowd.groups[0];
    group.start_z = 21;
    group.desired_speed = 1;
    group.goal_x = 50;
    group.goal_z = 32;
    scene.crowd.goal_radius = 2.5;
    const MadeUpWater water = stream(0.95);
    CHECK(fallen(scene, water, 25) == 1);
    scene.crowd.ropes = {rope_across(50.2)};
    CHECK(fallen(scene, water, 25) == 0);
    CrowdWorld crowd = make_crowd(scene);
    for (int i = 0; i < 40 * 30; ++i) step(crowd, water.view());
    CHECK(crowd.arrived == 1);

    // Across it: nobody is held back.
    group.start_x = 48;
    group.start_z = 25;
    group.goal_x = 54;
    group.goal_z = 25;
    crowd = make_crowd(scene);
    const MadeUpWater slow_water = stream(0.3, 0.5);
    for (int i = 0; i < 20 * 30; ++i) step(crowd, slow_water.view());
    CHECK(crowd.arrived == 1);
}

// One falls in the middle of the stream, in 1.2 m of water from z 15 m on; rescuers wait on the bank.
Scene with_rescuers(double start_x, double start_z) {
    Scene scene = one_carried();
    scene.crowd.groups[0].start_x = 55;
    scene.crowd.groups[0].start_z = 20;
    scene.crowd.groups[0].desired_speed = 1;
    scene.crowd.groups[0].goal_x = 45;
    scene.crowd.groups[0].goal_z = 5;
    scene.crowd.goal_radius = 1;
    scene.crowd.groups.push_back(scene.crowd.groups[0]);
    AgentGroup& rescuers = scene.crowd.groups[1];
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
        scene.crowd.groups[0].start_z = 32;
        scene.crowd.groups[0].goal_z = 45;
        scene.crowd.groups[1].body.skill = skill;
        scene.fluid.particle_spacing = 0.25;
        if (walled) scene.obstacles.push_back({{0, scene.world.length}, {28, 28.5}, 3});
        CrowdWorld crowd = make_crowd(scene);
        const MadeUpWater water = stream(speed, 1.05);
        for (int i = 0; i < 25 * 30; ++i) step(crowd, water.view());
        return crowd.agents.max_depth[1];
    };
    CHECK(deepest_met(Skill::braced, 0.62, false) > 0.9);
    CHECK(deepest_met(Skill::braced, 0.62, true) == 0);
    CHECK(deepest_met(Skill::poor, 0.62, false) == 0);
}

// Somebody holds on to a post at x 42 in the stream, in the lee of a house as seen from the rescuer on the bank.
Scene with_house(Skill of_rescuer, std::vector<Obstacle> obstacles) {
    Scene scene = with_rescuers(45, 13);
    scene.fluid.particle_spacing = 0.25;
    scene.crowd.navigation.rule = NavigationRule::automatic;
    scene.crowd.groups[0].start_x = 48;
    scene.crowd.groups[0].start_z = 29;
    scene.crowd.groups[0].goal_z = 45;
    scene.crowd.groups[1].body.skill = of_rescuer;
    scene.crowd.ropes = {rope_from(42, 29.3, 0)};
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
    const MadeUpWater water = stream(0.62, 1.05, 32);
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
    CHECK(!sets_out(rescue_in(with_house(Skill::poor, {house}), 20)));  // who would lose the feet on the way
    Scene straight = with_house(Skill::braced, {house});
    straight.crowd.navigation.rule = NavigationRule::straight;
    CHECK(!sets_out(rescue_in(straight, 20)));
}

TEST_CASE("Where nothing is in the way a house beside it changes no bit of what a rescuer does") {
    Scene scene = with_house(Skill::braced, {{{80, 84}, {30, 34}, 3}});
    const std::vector<Vector2d> led = rescue_in(scene, 20).places;
    scene.crowd.navigation.rule = NavigationRule::straight;
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
    scene.crowd.groups[1].body.skill = Skill::poor;
    CrowdWorld crowd = make_crowd(scene);
    const MadeUpWater water = stream(0.7, 1.2);
    const double mass = crowd.agents.mass[1], most = 0.07 * mass * scene.world.gravity, dt = crowd.dt;
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
        REQUIRE(crowd.links.empty());  // nobody throws from where it sits in the water
    }
    CHECK(!is_firm(crowd.agents.people.condition[1].state));
    CHECK(crowd.agents.position[1].x() < 40);
    CHECK(count_rescues(crowd).lost_feet == 1);

    scene.crowd.groups[1].body.skill = Skill::good;  // holds 408 N
    CrowdWorld firm = make_crowd(scene);
    for (int i = 0; i < 20 * 30; ++i) step(firm, water.view());
    CHECK(firm.agents.position[1].y() == Approx(14).margin(0.01));
    CHECK(count_rescues(firm).lost_feet == 0);
}

TEST_CASE("Links do not depend on the number of threads, and end with those who arrive") {
    Scene scene = side_by_side(4, HandInHand::along_z);
    scene.crowd.groups[0].desired_speed = 1;
    scene.crowd.goal_radius = 3;
    scene.crowd.groups[0].goal_x = 54;
    scene.crowd.groups[0].goal_z = 26;
    CrowdWorld crowd = make_crowd(scene);
    CHECK(crowd.links.size() == 3);
    for (int i = 0; i < 20 * 30; ++i) step(crowd, {});
    CHECK(crowd.arrived == 4);
    CHECK(crowd.links.empty());
}

}  // namespace wade::crowd::hands_test
