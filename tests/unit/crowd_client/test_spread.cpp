// What each agent has of its own: tau, also in time, mass, the deviation of the start.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "configs/scene/crowd.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/crowd_world.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::one_agent_scene;

namespace {

// `columns` agents in a row of pitch 0.05 m.
Scene row_of(int columns) {
    Scene scene = one_agent_scene(10, 25, 75, 50, 0);
    AgentGroup& group = scene.crowd->groups[0];
    group.columns = group.count = columns;
    group.pitch_x = 0.05;
    return scene;
}

}  // namespace

TEST_CASE("tau and mass fill their limits uniformly") {
    constexpr int n = 1000;
    Scene scene = row_of(n);
    scene.crowd->groups[0].tau = {0.4, 0.8};
    scene.crowd->groups[0].mass = {40, 100};
    const Agents agents = make_agents(scene);
    double tau = 0, mass = 0, product = 0;
    for (std::size_t id = 0; id < agents.size(); ++id) {
        REQUIRE((agents.tau[id] >= 0.4 && agents.tau[id] < 0.8));
        REQUIRE((agents.mass[id] >= 40 && agents.mass[id] < 100));
        const double u = (agents.tau[id] - 0.4) / 0.4, w = (agents.mass[id] - 40) / 60;
        tau += u / n;
        mass += w / n;
        product += (u - 0.5) * (w - 0.5) / n;
    }
    // Four standard deviations of the mean of n uniform numbers, and of the mean product of two independent ones.
    const double tolerance = 4 * std::sqrt(1.0 / 12 / n);
    CHECK(tau == Approx(0.5).margin(tolerance));
    CHECK(mass == Approx(0.5).margin(tolerance));
    CHECK(product == Approx(0).margin(4 * (1.0 / 12) / std::sqrt(static_cast<double>(n))));
}

TEST_CASE("Normal values have their mean and deviation, and keep their limits") {
    constexpr int n = 1800;
    Scene scene = row_of(n);
    scene.crowd->groups[0].body.height = {1.2, 2.2, 1.7, 0.1};
    scene.crowd->groups[0].body.age = {20, 30, 0, 1000};  // as good as uniform
    scene.crowd->groups[0].mass = {70, 80, 60, 5};        // the upper end of the values
    const Agents agents = make_agents(scene);
    double mean = 0, square = 0, age = 0;
    for (std::size_t id = 0; id < agents.size(); ++id) {
        const double height = agents.people.height[id];
        REQUIRE((height >= 1.2 && height <= 2.2));
        REQUIRE((agents.mass[id] >= 70 && agents.mass[id] <= 80));
        mean += height / n;
        square += (height - 1.7) * (height - 1.7) / n;
        age += agents.people.age[id] / n;
    }
    // Four standard deviations of each.
    CHECK(mean == Approx(1.7).margin(4 * 0.1 / std::sqrt(n)));
    CHECK(std::sqrt(square) == Approx(0.1).margin(4 * 0.1 / std::sqrt(2.0 * n)));
    CHECK(age == Approx(25).margin(4 * 10 / std::sqrt(12.0 * n)));
}

TEST_CASE("Half of the people are women unless the scene says otherwise, and a draw of bodies changes no other") {
    Scene scene = row_of(400);
    scene.crowd->groups[0].mass = {40, 100};
    const Agents plain = make_agents(scene);
    const auto women = [](const Agents& a) {
        return std::count(a.people.sex.begin(), a.people.sex.end(), Sex::female);
    };
    CHECK(women(plain) == Approx(200).margin(40));  // four standard deviations
    scene.crowd->groups[0].body.height = {1.5, 1.9};
    scene.crowd->groups[0].body.sex = SexRule::female;
    const Agents other = make_agents(scene);
    CHECK(women(other) == 400);
    CHECK(other.mass == plain.mass);
}

TEST_CASE("People of a table are taken in turn, and what it leaves open is drawn as without it") {
    Scene scene = row_of(5);
    scene.crowd->groups[0].mass = {40, 100};
    const Agents drawn = make_agents(scene);
    PersonRow small, large;
    small.height = 1.2;
    small.mass = 30;
    large.height = 1.9;
    large.skill = Skill::braced;
    scene.crowd->people = {small, large};
    const Agents agents = make_agents(scene);
    for (std::size_t id = 0; id < agents.size(); ++id) {
        const bool is_small = id % 2 == 0;
        CHECK(agents.people.height[id] == (is_small ? 1.2 : 1.9));
        CHECK(agents.mass[id] == (is_small ? 30 : drawn.mass[id]));
        CHECK(agents.people.friction[id] == (is_small ? 0.34 + (1.2 * 30 - 25) / 25 * (0.45 - 0.34) : 0.80));
    }
    scene.crowd->groups[0].people = {large};
    CHECK(make_agents(scene).people.height[0] == 1.9);
}

TEST_CASE("A draw depends on the seed and the agent alone") {
    Scene scene = row_of(5);
    scene.crowd->groups[0].tau = {0, 1};
    scene.crowd->groups[0].start_jitter = 0.3;
    const Agents few = make_agents(scene);
    scene.crowd->groups[0].columns = scene.crowd->groups[0].count = 9;
    scene.crowd->groups[0].mass = {40, 100};
    const Agents more = make_agents(scene);
    for (std::size_t id = 0; id < few.size(); ++id) {
        CHECK(more.tau[id] == few.tau[id]);
        CHECK(more.position[id] == few.position[id]);
    }
    scene.seed = 2;
    CHECK(make_agents(scene).tau[0] != few.tau[0]);
}

TEST_CASE("A value without limits is that value, for every agent") {
    Scene scene = row_of(5);
    scene.crowd->groups[0].tau = {0.3, 0.3};
    const Agents agents = make_agents(scene);
    for (std::size_t id = 0; id < agents.size(); ++id) {
        CHECK(agents.tau[id] == 0.3);
        CHECK(agents.mass[id] == 65);
        CHECK(agents.position[id] == Vector2d(10 + static_cast<double>(id) * 0.05, 25));
    }
}

TEST_CASE("Starts are spread over a square, inside the world and outside obstacles") {
    Scene scene = one_agent_scene(10, 0, 75, 50, 0);
    AgentGroup& group = scene.crowd->groups[0];
    group.columns = group.count = 300;
    group.pitch_x = 0;
    group.start_jitter = 2;
    scene.obstacles.push_back({{11, 14}, {0, 5}, 1});
    const Agents agents = make_agents(scene);
    std::set<std::pair<double, double>> places;
    bool left = false, far = false;
    for (const Vector2d& p : agents.position) {
        CHECK((p.x() >= 8 && p.x() < 11));  // the obstacle begins at 11
        CHECK((p.y() >= 0 && p.y() <= 2));  // mirrored at the edge z = 0
        left = left || p.x() < 8.5;
        far = far || p.y() > 1.8;
        places.insert({p.x(), p.y()});
    }
    CHECK((left && far));
    CHECK(places.size() == agents.size());
}

TEST_CASE("A deviation of many worlds is folded as often as it takes, so that no two agents start at one place") {
    Scene scene = one_agent_scene(10, 6, 14, 12, 0);
    scene.world->length = 20;
    scene.world->width = 12;
    AgentGroup& group = scene.crowd->groups[0];
    group.columns = group.count = 400;
    group.pitch_x = 0;
    group.start_jitter = 1000;
    const Agents agents = make_agents(scene);
    Vector2d mean = Vector2d::Zero();
    for (std::size_t i = 0; i < agents.size(); ++i) {
        const Vector2d& p = agents.position[i];
        REQUIRE((p.x() > 0 && p.x() < 20 && p.y() > 0 && p.y() < 12));
        for (std::size_t k = 0; k < i; ++k) REQUIRE((agents.position[k] - p).norm() >= 0.001);
        mean += p / 400;
    }
    // Four standard deviations of the mean of 400 uniform numbers: 4 L / sqrt(12 * 400).
    CHECK(mean.x() == Approx(10).margin(20 * 0.0577));
    CHECK(mean.y() == Approx(6).margin(12 * 0.0577));
}

TEST_CASE("Starts nearer than a millimetre are drawn again, and refused where there is no room") {
    Scene scene = one_agent_scene(10, 25, 75, 50, 0);
    scene.crowd->groups.push_back(scene.crowd->groups[0]);
    AgentGroup& grid = scene.crowd->groups[1];
    grid.columns = grid.count = 5;  // obstruct the drawn positions and are not moved by them
    grid.pitch_x = 0.004;
    grid.name = "grid";
    AgentGroup& heap = scene.crowd->groups[0];
    heap.columns = heap.count = 30;  // in 400 mm2; 30 discs of 1 mm cover 6 % of it
    heap.pitch_x = 0;
    heap.start_jitter = 0.01;
    const Agents agents = make_agents(scene);
    for (std::size_t i = 0; i < agents.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) CHECK((agents.position[k] - agents.position[i]).norm() >= 0.001);
    }
    CHECK(agents.position[30] == Vector2d(10, 25));
    scene.crowd->groups[0].start_jitter = 0.0002;
    CHECK_THROWS_WITH(make_agents(scene), Catch::Contains("/crowd/groups/0/start/jitter_m: 0.0002 m leaves agent "));
}

TEST_CASE("Starts near the joint of a periodic world stay in it") {
    Scene scene = one_agent_scene(0, 25, 75, 25, 0);
    scene.world->ends = Ends::periodic;
    scene.crowd->groups[0].columns = scene.crowd->groups[0].count = 100;
    scene.crowd->groups[0].pitch_x = 0;
    scene.crowd->groups[0].start_jitter = 1;
    bool behind = false, before = false;
    for (const Vector2d& p : make_agents(scene).position) {
        CHECK((p.x() >= 0 && p.x() < scene.world->length));
        behind = behind || p.x() > scene.world->length - 1;
        before = before || (p.x() > 0 && p.x() < 1);
    }
    CHECK((behind && before));
}

TEST_CASE("tau in time is straight between its points, jumps where two have one time, and ends with an event") {
    for (const double rate : {15.0, 30.0, 120.0}) {
        Scene scene = row_of(3);
        scene.frame_rate = scene.crowd->step_rate = rate;
        scene.crowd->groups[0].tau_history = {{1, 0.2}, {3, 0.8}, {3, 0.4}};
        PersonRow usual, other;
        other.tau_history = {{0, 1}, {4, 0}};
        scene.crowd->people = {usual, other, usual};
        scene.events.push_back({static_cast<std::uint64_t>(2 * rate), 2, std::nullopt, 0.7});
        CrowdWorld crowd = make_crowd(scene);
        CHECK((crowd.agents.tau[0] == 0.2 && crowd.agents.tau[1] == 1));
        const auto tau_at = [&](double time) {
            while (static_cast<double>(crowd.steps) < time * rate) step(crowd, {});
            return crowd.agents.tau;
        };
        CAPTURE(rate);
        CHECK(tau_at(1)[0] == 0.2);
        CHECK(tau_at(1)[1] == Approx(0.75));
        CHECK(tau_at(2 - 1 / rate)[2] == Approx(0.5 - 0.3 / rate));
        CHECK(tau_at(2)[0] == Approx(0.5));
        CHECK(tau_at(2)[2] == 0.7);
        CHECK(tau_at(3 - 1 / rate)[0] == Approx(0.8 - 0.3 / rate));
        CHECK(tau_at(3)[0] == 0.4);
        CHECK(tau_at(5)[0] == 0.4);
        CHECK(tau_at(5)[1] == 0);
        CHECK(tau_at(5)[2] == 0.7);
    }
}

TEST_CASE("A tau that rises in time moves people as far at any rate of steps") {
    std::vector<double> ways;
    for (const double rate : {15.0, 30.0, 60.0, 120.0}) {
        Scene scene = one_agent_scene(40, 25, 40, 50, 0);
        scene.frame_rate = scene.crowd->step_rate = rate;
        scene.crowd->groups[0].tau_history = {{0, 0}, {4, 1}};
        CrowdWorld crowd = make_crowd(scene);
        auto water = testing::uniform_water(34, 42, 24, 35, 0.125, 0.125, -1, 0);  // finer than what touches, 0.25 m
        for (float& mass : water.mass) mass *= 8;                                  // 1 m deep
        while (static_cast<double>(crowd.steps) < 6 * rate) step(crowd, water.view());
        ways.push_back(40 - crowd.agents.position[0].x());
    }
    CHECK(ways[3] > 2);
    // Each step takes tau at its end: half a step of 1/15 s at the water's 1 m/s is 1 % of this displacement.
    for (const double way : ways) CHECK(way == Approx(ways[3]).epsilon(0.02));
}
