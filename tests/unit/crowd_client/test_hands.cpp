// Linked people of a crowd in even streams.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <vector>

#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/hands.hpp"
#include "crowd_client/people/push.hpp"
#include "made_up_water.hpp"

namespace wade::crowd::hands_test {

using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::one_agent_scene;
using wade::crowd::testing::uniform_water;

MadeUpWater stream(double speed, double depth = 1) {
    MadeUpWater water = uniform_water(20, 62, 15, 40, 0.25, 0.25, -speed, 0);
    for (float& of_one : water.mass) of_one *= static_cast<float>(4 * depth);
    return water;
}

// `count` men of normal skill stand side by side across the stream.
Scene side_by_side(int count, HandInHand hands) {
    Scene scene = one_agent_scene(50, 25, 50, 25, 0);
    scene.fluid->particle_spacing = 0.25;
    scene.crowd->response = ResponseKind::measured;
    scene.crowd->goal_radius = 1e-9;
    AgentGroup& group = scene.crowd->groups[0];
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
    for (int i = 0; i < time * scene.crowd->step_rate; ++i) {
        step(crowd, water.view());
        for (std::size_t id = 0; id < crowd.agents.size(); ++id) {
            if (!has_ground(crowd.agents.people.condition[id].state)) ids.insert(id);
        }
    }
    return ids.size();
}

TEST_CASE("Links of a group join neighbours of its start grid, along x or along z") {
    Scene scene = side_by_side(5, HandInHand::along_z);
    scene.crowd->groups.push_back(scene.crowd->groups[0]);
    AgentGroup& group = scene.crowd->groups[1];
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
    scene.crowd->groups[1].body.sex = SexRule::female;
    CHECK(make_crowd(scene).links[4].grip == grip_of_women);
}

// Alone one topples at 0.874 m/s and slides at 1.060 m/s, in 1 m of water.
TEST_CASE("Hand in hand people stand in a stream that topples each alone, until they slide") {
    CHECK(fallen(side_by_side(3, HandInHand::none), stream(0.97), 5) == 3);
    CHECK(fallen(side_by_side(3, HandInHand::along_z), stream(0.97), 5) == 0);
    CHECK(fallen(side_by_side(3, HandInHand::along_z), stream(0.80), 5) == 0);
}

struct Walk {
    double speed = 0, wanted = 0;  // mean of all, m/s
    double widest = 0;             // distance of neighbours across the direction of walking, m
};

// So many walk along x in 0.6 m of still water, for 25 s; without the first 5.
Walk walk_of(int count, HandInHand hands) {
    Scene scene = side_by_side(1, hands);
    scene.coupling->shelter = Shelter::wake;
    AgentGroup& group = scene.crowd->groups[0];
    group.start_x = 30;
    group.columns = group.count = count;
    group.pitch_x = 0.7;
    group.desired_speed = 1.3;
    group.goal_z = 25;
    CrowdWorld crowd = make_crowd(scene);
    const std::vector<Vector2d>& place = crowd.agents.position;
    const MadeUpWater water = stream(0, 0.6);
    const auto mean_x = [&] {
        double sum = 0;
        for (const Vector2d& one : place) sum += one.x() / count;
        return sum;
    };
    Walk walk;
    for (int i = 0; i < 25 * 30; ++i) {
        if (i == 5 * 30) walk.speed = -mean_x() / 20;
        step(crowd, water.view());
    }
    walk.speed += mean_x() / 20;
    for (std::size_t id = 0; id < place.size(); ++id) {
        walk.wanted += crowd.agents.desired_speed[id] / count;
        if (id > 0) walk.widest = std::max(walk.widest, std::abs((place[id] - place[id - 1]).y()));
    }
    return walk;
}

// Gain of a file: eta (1 - s) (1 / r - 1), s the mean fraction of the drag; the first person has no wake shielding.
// With markers a lone person, and the first of a file, walks at 0.94 of its desired speed.
TEST_CASE("Ten hand in hand in file walk as fast as their wakes let them, and ten without hands do not") {
    const Walk alone = walk_of(1, HandInHand::none), file = walk_of(10, HandInHand::along_x);
    const double ratio = walking_speed_ratio(Sex::male, 0.6, 0, 9.81), width = body_width_share * usual_height;
    const double felt = 1 - wake_deficit(body_drag * width, width, 0.7, 0);
    const double gain = 0.11 * 0.9 * (1 - felt * felt) * (1 / ratio - 1);
    CHECK(file.wanted / alone.wanted - 1 == Approx(gain).epsilon(0.03));
    CHECK(file.speed / alone.speed - 1 > 0.9 * gain);
    CHECK(file.speed < file.wanted);
    CHECK(file.widest < 0.2);
    CHECK(walk_of(10, HandInHand::none).speed / alone.speed - 1 < 0.1 * gain);
}

TEST_CASE("Whoever is carried past is held by who stands, and is carried on where nobody helps") {
    Scene scene = side_by_side(1, HandInHand::none);
    scene.crowd->groups[0].start_x = 50;
    scene.crowd->groups[0].body.skill = Skill::unaware;
    scene.crowd->groups.push_back(scene.crowd->groups[0]);
    AgentGroup& helper = scene.crowd->groups[1];
    helper.name = "helper";
    helper.start_x = 45;
    helper.start_z = 25.3;
    helper.body.skill = Skill::braced;
    helper.body.ground_friction = 2;
    const MadeUpWater water = stream(0.6, 1.2);
    for (const bool helping : {false, true}) {
        scene.crowd->helping = helping;
        CrowdWorld crowd = make_crowd(scene);
        for (int i = 0; i < 25 * 30; ++i) step(crowd, water.view());
        CAPTURE(helping);
        CHECK(has_ground(crowd.agents.people.condition[1].state));
        CHECK((crowd.agents.people.condition[0].state == PersonState::holding) == helping);
        CHECK((crowd.agents.position[0].x() < 42) == !helping);
        CHECK(crowd.links.size() == (helping ? 1 : 0));
    }
}

// A tall person stands, two short ones float.
TEST_CASE("Along a chain in the stream the hold goes on from hand to hand") {
    Scene scene = side_by_side(1, HandInHand::along_x);
    AgentGroup& group = scene.crowd->groups[0];
    group.columns = group.count = 3;
    group.pitch_x = 0.7;
    group.desired_speed = 0;
    PersonRow firm, weak;
    firm.skill = Skill::braced;
    firm.ground_friction = 2;
    firm.bracing_arm = 0.5;
    firm.height = 2;
    firm.mass = 100;
    weak.skill = Skill::poor;
    weak.height = 1.45;
    weak.mass = 40;
    weak.sex = SexRule::male;
    group.people = {weak, weak, firm};
    CrowdWorld crowd = make_crowd(scene);
    const MadeUpWater water = stream(0.6, 1.3);
    for (int i = 0; i < 35 * 30; ++i) step(crowd, water.view());
    const People& people = crowd.agents.people;
    REQUIRE(crowd.links.size() == 2);
    CHECK(is_on_feet(people.condition[2].state));
    CHECK(people.condition[1].state == PersonState::holding);
    CHECK(people.condition[0].state == PersonState::holding);
    CHECK(people.stop[0].longest > 20);
    CHECK(people.stop[0].state == PersonState::holding);
}

// A hand that bears a share of its grip bears it for the endurance time of a hand, then lets go.
TEST_CASE("Who holds somebody in the stream lets go when the hand is tired, at any rate of steps") {
    Scene scene = side_by_side(1, HandInHand::none);
    scene.crowd->helping = scene.crowd->fatigue = true;
    scene.crowd->groups[0].body.skill = Skill::unaware;
    scene.crowd->groups.push_back(scene.crowd->groups[0]);
    AgentGroup& helper = scene.crowd->groups[1];
    helper.name = "helper";
    helper.start_x = 45;
    helper.start_z = 25.3;
    helper.body.skill = Skill::braced;
    helper.body.ground_friction = 2;
    MadeUpWater water = uniform_water(28, 56, 18, 32, 0.5, 0.5, -0.7, 0);
    for (float& of_one : water.mass) of_one *= 2.4F;  // 1.2 m
    std::vector<double> times;
    for (const double rate : {15.0, 60.0}) {
        scene.crowd->step_rate = scene.frame_rate = rate;
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

// One person that falls at x 50 and floats away in 1.2 m of water.
Scene one_carried() {
    Scene scene = side_by_side(1, HandInHand::none);
    scene.crowd->groups[0].body.skill = Skill::unaware;
    return scene;
}

TEST_CASE("Ropes across the stream, with a free end and posts hold whom a stream carries past, but no strong one") {
    const auto x_after = [&](const Rope& rope, double speed) {
        Scene scene = one_carried();
        scene.crowd->ropes = {rope};
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
    AgentGroup& group = scene.crowd->groups[0];
    group.start_z = 21;
    group.desired_speed = 1;
    group.goal_x = 50;
    group.goal_z = 32;
    scene.crowd->goal_radius = 2.5;
    const MadeUpWater water = stream(0.95);
    CHECK(fallen(scene, water, 25) == 1);
    scene.crowd->ropes = {rope_across(50.2)};
    CHECK(fallen(scene, water, 25) == 0);
    CrowdWorld crowd = make_crowd(scene);
    for (int i = 0; i < 40 * 30; ++i) step(crowd, water.view());
    CHECK(crowd.arrived == 1);

    // Across the rope: it holds no person back.
    group.start_x = 48;
    group.start_z = 25;
    group.goal_x = 54;
    group.goal_z = 25;
    crowd = make_crowd(scene);
    const MadeUpWater slow_water = stream(0.3, 0.5);
    for (int i = 0; i < 20 * 30; ++i) step(crowd, slow_water.view());
    CHECK(crowd.arrived == 1);
}

TEST_CASE("Links do not depend on the number of threads, and end with those who arrive") {
    Scene scene = side_by_side(4, HandInHand::along_z);
    scene.crowd->groups[0].desired_speed = 1;
    scene.crowd->goal_radius = 3;
    scene.crowd->groups[0].goal_x = 54;
    scene.crowd->groups[0].goal_z = 26;
    CrowdWorld crowd = make_crowd(scene);
    CHECK(crowd.links.size() == 3);
    for (int i = 0; i < 20 * 30; ++i) step(crowd, {});
    CHECK(crowd.arrived == 4);
    CHECK(crowd.links.empty());
}

}  // namespace wade::crowd::hands_test
