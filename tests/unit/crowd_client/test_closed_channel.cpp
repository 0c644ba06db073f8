// People in a closed channel: its ends are walls, wherever it lies and whichever way it is turned.

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "crowd_client/crowd_world.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::uniform_water;

namespace {

constexpr double length = 12, width = 4;  // of the channel, m

// A channel that begins at `x` in a world that ends as far behind it, and its mirror image.
struct Twin {
    double x = 0;
    bool mirrored = false;
    [[nodiscard]] double place(double along) const { return mirrored ? x + length - along : x + along; }
};

// Nine people near the end at place 0, who walk to the other one.
Scene scene_of(const Twin& twin, BodyRule bodies, CouplingRule rule, std::uint64_t seed) {
    Scene scene;
    scene.seed = seed;
    scene.world = {2 * twin.x + length, width, 9.81, Ends::open};
    scene.channel.x = {twin.x, twin.x + length};
    scene.channel.z = {0, width};
    scene.channel.flow = Flow::closed;
    scene.coupling.rule = rule;
    scene.crowd.bodies = bodies;
    scene.crowd.markers = MarkerRule::redrawn;
    scene.crowd.goal_radius = 1.5;
    AgentGroup group;
    group.columns = group.rows = 3;
    group.count = 9;
    group.start_x = twin.place(0.3);
    group.pitch_x = twin.mirrored ? -1 : 1;
    group.start_z = 1;
    group.goal_x = twin.place(length - 1.5);
    group.goal_z = 0.5 * width;
    group.tau = 1;
    scene.crowd.groups.push_back(group);
    return scene;
}

// For the first seconds a wave of 3 m/s against the end; then the channel is dry.
std::vector<double> arrival_times(const Twin& twin, BodyRule bodies, CouplingRule rule, std::uint64_t seed) {
    CrowdWorld crowd = make_crowd(scene_of(twin, bodies, rule, seed));
    const MadeUpWater wave = uniform_water(twin.x, twin.x + length, 0, width, 1, 0.5, twin.mirrored ? 3 : -3, 0);
    const MadeUpWater none;
    for (int i = 0; i < 900 && !crowd.active.empty(); ++i) {
        step(crowd, i < 60 ? wave.view() : none.view());
        REQUIRE(crowd.dead == 0);
        for (const Vector2d& p : crowd.agents.position) REQUIRE(crowd.scene.channel.x.contains(p.x()));
    }
    REQUIRE(crowd.arrived == 9);
    std::vector<double> times;
    for (const std::uint64_t end : crowd.agents.end_step) times.push_back(static_cast<double>(end) * crowd.dt);
    return times;
}

struct Sample {
    double mean = 0, variance_of_mean = 0;
};

// Of the runs' mean times over ten seeds, s.
Sample sample_of(const Twin& twin, BodyRule bodies, CouplingRule rule) {
    constexpr int seeds = 10;
    double sum = 0, squares = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
        double mean = 0;
        for (const double time : arrival_times(twin, bodies, rule, static_cast<std::uint64_t>(seed))) mean += time / 9;
        sum += mean;
        squares += mean * mean;
    }
    const double mean = sum / seeds;
    return {mean, (squares / seeds - mean * mean) / (seeds - 1)};
}

}  // namespace

TEST_CASE("A wave in a closed channel drowns nobody at its ends, and mirrored or moved it costs as much time") {
    const BodyRule bodies = GENERATE(BodyRule::none, BodyRule::fast, BodyRule::human);
    const CouplingRule rule = GENERATE(CouplingRule::per_frame, CouplingRule::continuous);
    const Sample first = sample_of({0, false}, bodies, rule);
    CHECK(first.mean > 2 + (length - 5) / 1.3);  // the wave held them up
    for (const Twin& twin : {Twin{0, true}, Twin{5, false}, Twin{5, true}}) {
        const Sample other = sample_of(twin, bodies, rule);
        // Two means of ten seeds differ by more than 3.9 times their standard error once in a thousand (Student's t with
        // 18 degrees of freedom); the first also by a step.
        const double scatter = std::sqrt(first.variance_of_mean + other.variance_of_mean);
        INFO("channel at " << twin.x << " m, mirrored " << twin.mirrored << ", standard error " << scatter << " s");
        CHECK(other.mean == Approx(first.mean).margin(3.9 * scatter));
    }
}

TEST_CASE("Where the water flows on, the same wave carries people over the fall") {
    Scene scene = scene_of({0, false}, GENERATE(BodyRule::none, BodyRule::fast), CouplingRule::per_frame, 1);
    scene.channel.flow = GENERATE(Flow::emitter, Flow::recirculating, Flow::periodic);
    CrowdWorld crowd = make_crowd(scene);
    const MadeUpWater wave = uniform_water(0, length, 0, width, 1, 0.5, -3, 0);
    for (int i = 0; i < 60; ++i) step(crowd, wave.view());
    CHECK(crowd.dead > 0);
}
