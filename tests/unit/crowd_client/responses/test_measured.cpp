// People in even streams, stepped with the whole crowd.

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/standing.hpp"
#include "crowd_client/water/water_met.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::one_agent_scene;
using wade::crowd::testing::uniform_water;

namespace {

// A person of 1.70 m and 65 kg stands in a river.
Scene standing_in_a_river() {
    Scene scene = one_agent_scene(50, 25, 50, 50, 0);
    scene.fluid->particle_spacing = 0.25;
    scene.crowd->response = ResponseKind::measured;
    AgentGroup& group = scene.crowd->groups[0];
    group.tau.reset();
    group.desired_speed = 0;
    group.body.sex = SexRule::male;
    return scene;
}

// Water on a lattice that has the depth exactly, everywhere that the person can reach in the time of a test.
MadeUpWater stream(double depth, double speed) {
    MadeUpWater water = uniform_water(20, 56, 15, 40, 0.25, 0.25, -speed, 0);
    for (float& mass : water.mass) mass *= static_cast<float>(depth / 0.25);
    return water;
}

CrowdWorld crowd_at(Scene scene, double rate) {
    scene.crowd->step_rate = scene.frame_rate = rate;
    return make_crowd(scene);
}

PersonState state_of(const CrowdWorld& crowd) {
    return crowd.agents.people.condition[0].state;
}

constexpr std::array rates{15.0, 30.0, 60.0, 120.0};

}  // namespace

TEST_CASE("Standing water of half a metre never leads out of walking") {
    CrowdWorld crowd = crowd_at(standing_in_a_river(), 30);
    const MadeUpWater water = stream(0.5, 0);
    for (int i = 0; i < 300; ++i) {
        step(crowd, water.view());
        REQUIRE(state_of(crowd) == PersonState::walking);
    }
    CHECK(crowd.agents.position[0] == Vector2d(50, 25));
}

TEST_CASE("In a metre of water at 2.5 m/s one slides after 0.1 s, topples at 0.3 s, is carried at 0.6 s, at any rate") {
    const MadeUpWater water = stream(1, 2.5);
    for (const double rate : rates) {
        CrowdWorld crowd = crowd_at(standing_in_a_river(), rate);
        std::array<double, person_states.size()> first{};
        for (int i = 1; i <= rate; ++i) {
            step(crowd, water.view());
            double& time = first[static_cast<std::size_t>(state_of(crowd))];
            if (time == 0) time = i / rate;
        }
        CAPTURE(rate);
        const auto entered = [&](PersonState state) { return first[static_cast<std::size_t>(state)]; };
        CHECK(entered(PersonState::sliding) == Approx(0.1).margin(1 / rate));
        CHECK(entered(PersonState::toppled) == Approx(0.3).margin(1 / rate));
        CHECK(entered(PersonState::carried) == Approx(0.6).margin(1.01 / rate));
        CHECK(static_cast<double>(crowd.agents.lost_feet_step[0]) / rate == Approx(entered(PersonState::toppled)));
        for (int i = 0; i < 10 * rate; ++i) step(crowd, stream(0.3, 0).view());
        CHECK(state_of(crowd) == PersonState::walking);
        CHECK(crowd.agents.people.worst[0] == PersonState::carried);
    }
}

// Steady water, so that a step of the crowd hides nothing but its own middle.
TEST_CASE("In steady water half a step a second leads to the same states at the same times as 120") {
    struct Water {
        double depth, speed;
    };
    const Water given = GENERATE(Water{0.5, 0}, Water{1, 2.5}, Water{0.6, 1.6}, Water{0.15, 2}, Water{1.6, 0.5});
    const MadeUpWater water = stream(given.depth, given.speed);
    constexpr double time = 8, fastest = 120;  // s, steps a second
    const auto states_at = [&](double rate) {
        CrowdWorld crowd = crowd_at(standing_in_a_river(), rate);
        std::vector<PersonState> states;
        for (int i = 0; i < time * rate; ++i) {
            step(crowd, water.view());
            states.push_back(state_of(crowd));
        }
        return states;
    };
    const std::vector<PersonState> reference = states_at(fastest);
    for (const double rate : {0.5, 1.0, 1.5, 2.0, 4.0, 5.0, 8.0, 10.0, 15.0, 30.0}) {
        const std::vector<PersonState> states = states_at(rate);
        for (std::size_t k = 0; k < states.size(); ++k) {
            const double at = static_cast<double>(k + 1) / rate;
            const auto of_reference = [&](double t) {
                return reference[static_cast<std::size_t>(
                                     std::clamp(std::lround(t * fastest), 1L, std::lround(time * fastest))) -
                                 1];
            };
            bool same = false;
            for (double off = -0.1; off <= 0.1; off += 1 / fastest) same = same || of_reference(at + off) == states[k];
            CAPTURE(given.depth, given.speed, rate, at, static_cast<int>(states[k]),
                    static_cast<int>(of_reference(at)));
            CHECK(same);
        }
    }
}

TEST_CASE("Who slides goes as fast as drag and friction balance, and its tau is that of its slip demand") {
    Scene scene = standing_in_a_river();
    scene.crowd->groups[0].body.skill = Skill::braced;  // slides before it topples
    scene.crowd->groups[0].body.ground_friction = 0.3;
    CrowdWorld crowd = crowd_at(scene, 30);
    const MadeUpWater water = stream(0.7, 1.5);
    for (int i = 0; i < 300; ++i) step(crowd, water.view());
    const wade::crowd::People& them = crowd.agents.people;
    CHECK(state_of(crowd) == PersonState::sliding);
    const double depth = them.depth[0];
    CHECK(depth == Approx(0.7).epsilon(0.03));
    const double k = drag_upright(1.7, depth, {}), grip = 0.3 * weight_on_feet({1.7, 65}, depth, {});
    // Depth and so the balance change by up to 2 % as it passes the points of the lattice.
    CHECK(crowd.agents.momentary[0].x() == Approx(-1.5 + std::sqrt(grip / k)).epsilon(0.05));
    CHECK(crowd.agents.tau[0] == Approx(1 - grip / (k * 1.5 * 1.5)));
    // The stream is the same all the time, but for what the points of the lattice change and the first 0.3 s.
    CHECK(mean_tau_met(crowd.agents, 0) == Approx(crowd.agents.tau[0]).epsilon(0.05));
    CHECK(crowd.agents.people.worst[0] == PersonState::sliding);
    CHECK(crowd.agents.lost_feet_step[0] == 0);
}

TEST_CASE("Drift, time to topple and arrival are the same at 15 to 120 steps a second") {
    struct Run {
        double drift = 0, toppled = 0, arrival = 0;
    };
    // A stream that grows for ten seconds, and a person that crosses a stream 0.5 m deep.
    const auto run = [](double rate) {
        Run result;
        CrowdWorld stands = crowd_at(standing_in_a_river(), rate);
        for (int i = 1; i <= 12 * rate; ++i) {
            const double time = i / rate;
            step(stands, stream(1.05, std::min(1.0, 0.1 * time) * 1.2).view());
            const bool fell = state_of(stands) == PersonState::toppled;
            if (fell && result.toppled == 0) result.toppled = time;
        }
        result.drift = 50 - stands.agents.position[0].x();
        Scene scene = standing_in_a_river();
        scene.crowd->groups[0].desired_speed = 1.3;
        scene.crowd->groups[0].goal_z = 35;
        scene.crowd->goal_radius = 0.5;
        CrowdWorld crosses = crowd_at(scene, rate);
        const MadeUpWater ford = stream(0.5, 1);
        while (crosses.arrived == 0 && static_cast<double>(crosses.steps) < 60 * rate) step(crosses, ford.view());
        result.arrival = static_cast<double>(crosses.steps) / rate;
        return result;
    };
    const Run fine = run(120);
    CHECK(fine.toppled > 5);
    CHECK(fine.drift > 1);
    CHECK(fine.arrival < 59);
    for (const double rate : {15.0, 30.0, 60.0}) {
        const Run other = run(rate);
        CAPTURE(rate);
        CHECK(other.toppled == Approx(fine.toppled).epsilon(0.02));
        CHECK(other.drift == Approx(fine.drift).epsilon(0.02));
        CHECK(other.arrival == Approx(fine.arrival).epsilon(0.02));
    }
}

TEST_CASE("People walk slower in water, and as fast as before out of it") {
    Scene scene = standing_in_a_river();
    scene.crowd->groups[0].desired_speed = 1.3;
    scene.crowd->groups[0].goal_z = 45;
    const auto way_of = [](CrowdWorld& crowd, const MadeUpWater& water) {
        for (int i = 0; i < 60; ++i) step(crowd, water.view());
        const Vector2d from = crowd.agents.position[0];
        for (int i = 0; i < 120; ++i) step(crowd, water.view());
        return (crowd.agents.position[0] - from).norm();
    };
    CrowdWorld crowd = crowd_at(scene, 30), on_land = crowd_at(scene, 30);
    const double dry = way_of(on_land, MadeUpWater{});
    // The speed ratio is 0.614 for the men of Li et al.; markers bend every path a little.
    CHECK(way_of(crowd, stream(0.35, 0)) == Approx(0.614 * dry).epsilon(0.05));
    CHECK(crowd.agents.desired_speed[0] == Approx(0.614 * 1.3).epsilon(0.01));
    CHECK(way_of(crowd, MadeUpWater{}) == Approx(dry).epsilon(0.05));
    CHECK(crowd.agents.desired_speed[0] == Approx(1.3).epsilon(0.001));
}

TEST_CASE("Who walks in a file through still water is faster in the lee of those before it, with shelter alone") {
    Scene scene = standing_in_a_river();
    AgentGroup& group = scene.crowd->groups[0];
    group.desired_speed = 1.3;
    group.columns = group.count = 10;
    group.start_x = 40;
    group.pitch_x = 0.6;
    group.goal_x = 90;
    const auto speeds = [&](Shelter shelter) {
        scene.coupling->shelter = shelter;
        CrowdWorld crowd = crowd_at(scene, 30);
        for (Vector2d& velocity : crowd.agents.velocity) velocity = {0.65, 0};
        step(crowd, stream(0.6, 0).view());
        return crowd.agents.desired_speed;
    };
    const std::vector<double> alone = speeds(Shelter::off), sheltered = speeds(Shelter::wake);
    double mean = 0;
    for (std::size_t id = 0; id < 10; ++id) mean += sheltered[id] / alone[id] / 10;
    CHECK(alone[0] == Approx(1.3 * walking_speed_ratio(Sex::male, 0.6, 0, 9.81)).epsilon(0.02));
    CHECK(sheltered[9] == alone[9]);                  // the first of them
    CHECK(mean - 1 == Approx(0.0905).margin(0.004));  // 0.177 of the drag is left of ten
}

TEST_CASE("Who has a given tau, or gets one, answers as the paper's, beside those who answer by their bodies") {
    Scene scene = standing_in_a_river();
    AgentGroup paper = scene.crowd->groups[0];
    paper.name = "paper";
    paper.start_x = 45;
    paper.tau = 0.5;
    scene.crowd->groups.push_back(paper);
    Scene alone = scene;
    alone.crowd->response = ResponseKind::paper;
    alone.crowd->groups.erase(alone.crowd->groups.begin());
    TauEvent event;
    event.frame = 10;
    event.agent = 0;
    event.tau = 0;
    scene.events.push_back(event);
    CrowdWorld both = crowd_at(scene, 30), one = crowd_at(alone, 30);
    const MadeUpWater water = stream(1, 1);
    Vector2d at_event;
    for (int i = 1; i <= 30; ++i) {
        step(both, water.view());
        step(one, water.view());
        if (i == 9) at_event = both.agents.position[0];
        REQUIRE(both.agents.position[1] == one.agents.position[0]);
    }
    CHECK(at_event.x() <= 50);
    CHECK(both.agents.position[0].x() == Approx(at_event.x()).margin(0.05));
    CHECK(both.agents.tau[0] == 0);
}

TEST_CASE("With the hazard \"under\" a floating non-swimmer drowns after a minute, a swimmer gets across") {
    Scene scene = standing_in_a_river();
    scene.crowd->drift_hazard.is_under = true;
    scene.crowd->groups[0].desired_speed = 1;
    scene.crowd->groups[0].goal_z = 39;
    CrowdWorld sinks = crowd_at(scene, 30);
    scene.crowd->groups[0].body.can_swim = true;
    CrowdWorld swims = crowd_at(scene, 30);
    const MadeUpWater lake = stream(2, 0);
    for (int i = 0; i < 62 * 30; ++i) {
        step(sinks, lake.view());
        step(swims, lake.view());
    }
    CHECK(sinks.dead == 1);
    CHECK(state_name(sinks, 0) == "drowned");
    CHECK(static_cast<double>(sinks.agents.end_step[0]) / 30 == Approx(60.3).margin(0.1));
    CHECK(swims.arrived == 1);
    CHECK(static_cast<double>(swims.agents.end_step[0]) / 30 ==
          Approx(11 / std::sqrt(45 / drag_upright(1.7, 2, {}))).epsilon(0.1));
}

TEST_CASE("The water carries people over the fall, nobody walks over it") {
    Scene scene = standing_in_a_river();
    scene.crowd->groups[0].start_x = 3;
    CrowdWorld crowd = crowd_at(scene, 30);
    MadeUpWater water = uniform_water(0, 20, 15, 35, 1, 0.25, -2.5, 0);
    for (int i = 0; i < 150; ++i) step(crowd, water.view());
    CHECK(crowd.dead == 1);
    CHECK(state_name(crowd, 0) == "dead");
}

TEST_CASE("People in water deeper than that of the flumes are counted") {
    CrowdWorld deep = crowd_at(standing_in_a_river(), 30), shallow = crowd_at(standing_in_a_river(), 30);
    const MadeUpWater deep_water = stream(1.3, 0.7), shallow_water = stream(0.7, 1.0);
    for (int i = 0; i < 30; ++i) {
        step(deep, deep_water.view());
        step(shallow, shallow_water.view());
    }
    CHECK(deep.agents.people.beyond[0] > 0);
    CHECK(shallow.agents.people.beyond[0] == 0);
}

TEST_CASE("Bodies, threads and how a step is divided do not keep people from answering") {
    for (const BodyRule bodies : {BodyRule::none, BodyRule::fast, BodyRule::human}) {
        Scene scene = standing_in_a_river();
        AgentGroup& group = scene.crowd->groups[0];
        group.columns = 5;
        group.rows = 4;
        group.count = 20;
        group.start_x = 44;
        group.start_z = 20;
        group.desired_speed = 1.3;
        scene.crowd->markers = MarkerRule::redrawn;
        scene.crowd->bodies = bodies;
        for (const double rate : {2.0, 30.0}) {
            CrowdWorld crowd = crowd_at(scene, rate);
            const MadeUpWater water = stream(1, 2.5);
            for (int i = 0; i < 2 * rate; ++i) step(crowd, water.view());
            for (const std::uint32_t id : crowd.active) {
                CHECK(crowd.agents.position[id].allFinite());
                CHECK(crowd.agents.velocity[id].x() < -1);
            }
        }
    }
}

// T is the load on a fresh person of normal skill, lambda 0.09. Its legs hold this load while at most 1 - T of them are
// tired. Then they yield, and at 0.04 / 0.09 + (1 - 0.04 / 0.09) strength = T the person topples.
TEST_CASE("Whom a stream does not topple it topples when the legs are tired, after the time of the closed form") {
    const MadeUpWater water = stream(1, 0.8);
    Scene scene = standing_in_a_river();
    CrowdWorld fresh = crowd_at(scene, 15);
    for (int i = 0; i < 30 * 15; ++i) {
        step(fresh, water.view());
        REQUIRE(state_of(fresh) == PersonState::effort);
    }
    const double demand = fresh.agents.people.topple[0], of_dummy = 0.04 / 0.09;
    CHECK((demand > 0.8 && demand < 0.95));
    const double strength = (demand - of_dummy) / (1 - of_dummy), f = 0.015, r = 0.00149, end = f / (f + r);
    const double held = std::log(f * demand / (f * demand - r * (1 - demand))) / r;
    const double yields = std::log((end - (1 - demand)) / (end - (1 - strength))) / (f + r);
    scene.crowd->fatigue = true;
    for (const double rate : rates) {
        CrowdWorld crowd = crowd_at(scene, rate);
        double toppled = 0;
        for (int i = 1; i <= 30 * rate && toppled == 0; ++i) {
            step(crowd, water.view());
            if (state_of(crowd) == PersonState::toppled) toppled = i / rate;
        }
        CAPTURE(rate, held, yields);
        CHECK(toppled == Approx(held + yields + 0.3).epsilon(0.02));
    }
}

TEST_CASE(
    "Who cannot stand up where it is counts as standing, and the warning names the water and the keys of people") {
    Scene scene = standing_in_a_river();
    scene.crowd->groups[0].desired_speed = 1.3;
    scene.crowd->groups[0].body.bracing_arm = 0.01;  // topples wherever it stands up, and squats firmly
    CrowdWorld crowd = crowd_at(scene, 10);
    const MadeUpWater water = stream(0.4, 1.2);
    for (int i = 0; i < 450; ++i) step(crowd, water.view());  // 30 s at its position, after the fall
    REQUIRE(state_of(crowd) == PersonState::recovering);
    REQUIRE(count_standing(crowd) == 1);
    CHECK_THAT(crowd.warnings.back(), Catch::Contains("keeps them from walking") && Catch::Contains("skill"));
}

// A wall across the stream, 8 m below the person. Its air ends 60 s after it is pinned.
TEST_CASE("A body that the stream presses on a wall is pinned after 10 s at rest, and drowns when the air ends") {
    Scene scene = standing_in_a_river();
    scene.crowd->groups[0].body.skill = Skill::unaware;
    scene.crowd->groups[0].desired_speed = 1.3;
    scene.obstacles.push_back({{41, 42}, {0, 50}, 3});
    scene.crowd->markers = MarkerRule::redrawn;
    scene.crowd->bodies = GENERATE(BodyRule::none, BodyRule::human);
    const MadeUpWater water = stream(1.2, 1.5);
    for (const double rate : {2.0, 15.0, 60.0}) {
        CrowdWorld crowd = crowd_at(scene, rate);
        double pinned = 0, drowned = 0;
        for (int i = 1; i <= 100 * rate && drowned == 0; ++i) {
            step(crowd, water.view());
            if (state_of(crowd) == PersonState::pinned && pinned == 0) pinned = i / rate;
            if (state_of(crowd) == PersonState::drowned) drowned = i / rate;
            if (std::lround(60 * rate) == i) CHECK(count_standing(crowd) == 1);
        }
        const Stop& stop = crowd.agents.people.stop[0];
        CAPTURE(rate);
        CHECK((pinned > 15 && pinned < 30));
        CHECK(drowned == Approx(pinned + 60).margin(2 / rate + 0.1));
        CHECK(stop.state == PersonState::pinned);
        CHECK(stop.longest > 60);
        CHECK(crowd.agents.people.condition[0].drift.end == DriftEnd::pinned);
    }
}

TEST_CASE("A body beside a wall in still water, in a stream along it or in a stream without walls is not pinned") {
    Scene scene = standing_in_a_river();
    scene.crowd->drift_hazard = {0, 0, 0};
    scene.crowd->groups[0].desired_speed = 0.5;
    scene.crowd->groups[0].body.can_swim = GENERATE(false, true);
    struct Case {
        double speed;
        Obstacle wall;
    };
    const Case given = GENERATE(Case{0, {{51, 52}, {0, 50}, 3}}, Case{0.5, {{0, 100}, {25.5, 26}, 3}},
                                Case{0.02, {{90, 91}, {0, 1}, 3}});
    scene.obstacles.push_back(given.wall);
    CrowdWorld crowd = crowd_at(scene, 15);
    const MadeUpWater water = stream(1.8, given.speed);
    for (int i = 0; i < 40 * 15; ++i) {
        step(crowd, water.view());
        REQUIRE(state_of(crowd) != PersonState::pinned);
    }
}

// The limits of h v are those of the guideline that the rule is taken from: 0.22 m2/s at 0.09 to 0.16 m (Martinez-Gomariz et al. 2016).
TEST_CASE("In 0.09 to 0.16 m of water a standing adult loses its footing at 0.18 to 0.32 m2/s") {
    const Skill skill = GENERATE(Skill::braced, Skill::good, Skill::normal);
    for (const double depth : {0.09, 0.12, 0.155}) {  // felt within 3 %
        const auto fails = [&](double speed) {
            Scene scene = standing_in_a_river();
            scene.crowd->groups[0].body.skill = skill;
            CrowdWorld crowd = crowd_at(scene, 30);
            const MadeUpWater water = stream(depth, speed);
            for (int i = 0; i < 60; ++i) step(crowd, water.view());
            return crowd.agents.people.worst[0] >= PersonState::sliding && crowd.agents.position[0].x() < 50;
        };
        CAPTURE(static_cast<int>(skill), depth);
        CHECK_FALSE(fails(0.97 * 0.18 / depth));
        CHECK(fails(1.03 * 0.32 / depth));
    }
}

TEST_CASE("Still water slips no one at any speed of walking or running") {
    const Skill skill = GENERATE(Skill::braced, Skill::normal, Skill::unaware, Skill::poor);
    const double speed = GENERATE(0.5, 1.3, 2.5, 5.0, 10.0);
    for (const double depth : {0.03, 0.06, 0.12, 0.18, 0.3, 0.5, 0.8, 1.1, 1.4}) {
        Scene scene = standing_in_a_river();
        scene.crowd->groups[0].body.skill = skill;
        scene.crowd->groups[0].desired_speed = speed;
        scene.crowd->groups[0].goal_x = 22;
        CrowdWorld crowd = crowd_at(scene, 15);
        const MadeUpWater water = stream(depth, 0);
        for (int i = 0; i < 6 * 15; ++i) step(crowd, water.view());
        CAPTURE(static_cast<int>(skill), speed, depth);
        CHECK(crowd.agents.people.worst[0] < PersonState::sliding);
    }
}

TEST_CASE(
    "People fallen in fast shallow water get up below 1.6 m/s, and stand firm again below 0.8 of the fastest footing") {
    const auto after = [](double depth, double first, double speed) {
        CrowdWorld crowd = crowd_at(standing_in_a_river(), 30);
        for (int i = 0; i < 30; ++i) step(crowd, stream(depth, first).view());
        crowd.agents.position[0] = {50, 25};
        for (int i = 0; i < 90; ++i) step(crowd, stream(depth, speed).view());
        return state_of(crowd);
    };
    CHECK(after(0.12, 2.1, 1.65) == PersonState::sliding);
    CHECK(is_firm(after(0.12, 2.1, 1.55)));
    CrowdWorld fallen = crowd_at(standing_in_a_river(), 30);
    fallen.agents.people.condition[0].state = PersonState::carried;
    for (int i = 0; i < 150; ++i) step(fallen, stream(0.12, 1.7).view());
    CHECK(state_of(fallen) == PersonState::carried);
    fallen.agents.position[0] = {50, 25};
    for (int i = 0; i < 150; ++i) step(fallen, stream(0.12, 1.5).view());
    CHECK(is_firm(state_of(fallen)));
}
