#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "configs/scene/channel.hpp"
#include "configs/scene/crowd.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/markers/counter_random.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::one_agent_scene;
using wade::crowd::testing::uniform_water;

namespace {

RagdollRule rule_of(RagdollCondition condition) {
    RagdollRule rule;
    rule.condition = condition;
    return rule;
}

Scene tumbling_scene(RagdollCondition condition, double tau = 0.9, double v_f = 2.5) {
    Scene scene = one_agent_scene(50, 25, 75, 50, tau);
    scene.channel->velocity = v_f;
    scene.crowd->ragdoll.condition = condition;
    return scene;
}

// Returns the ragdolls of the same agent at rest (tau 0), after half a second of the same water.
std::vector<Ragdoll> ragdolls_of(Scene scene, const MadeUpWater& water) {
    scene.crowd->ragdoll.tau_min = 0;
    scene.crowd->groups[0].tau = 0;
    scene.crowd->groups[0].desired_speed = 0;
    CrowdWorld crowd = make_crowd(scene);
    for (int i = 0; i < 15; ++i) step(crowd, water.view());
    return crowd.ragdolls;
}

}  // namespace

TEST_CASE("The paper's condition asks for a tau of at least 0.8 and for more than 2 m/s of v_F") {
    const RagdollRule rule = rule_of(RagdollCondition::paper);
    const CellWater at_rest{1, 0};
    CHECK(ragdoll_holds(rule, 0.8, 2.001, at_rest));
    CHECK_FALSE(ragdoll_holds(rule, 0.8, 2, at_rest));
    CHECK_FALSE(ragdoll_holds(rule, 0.799, 3, at_rest));
}

TEST_CASE("The local condition looks at the water of the agent's cell instead of v_F") {
    const RagdollRule rule = rule_of(RagdollCondition::local_speed);
    CHECK(ragdoll_holds(rule, 0.8, 0, {0.1, 2.001}));
    CHECK_FALSE(ragdoll_holds(rule, 0.8, 5, {0.1, 2}));
    CHECK_FALSE(ragdoll_holds(rule, 0.7, 5, {0.1, 3}));
}

TEST_CASE("The condition on depth times speed includes its bound and takes every tau") {
    const RagdollRule rule = rule_of(RagdollCondition::depth_speed);
    CHECK(ragdoll_holds(rule, 0, 0, {0.5, 1.5}));
    CHECK_FALSE(ragdoll_holds(rule, 1, 5, {0.5, 1.499}));
    CHECK_FALSE(ragdoll_holds(rule_of(RagdollCondition::off), 1, 5, {5, 5}));
}

TEST_CASE("Thresholds are those of the rule") {
    RagdollRule rule = rule_of(RagdollCondition::paper);
    rule.tau_min = 0.5;
    rule.speed = 1;
    CHECK(ragdoll_holds(rule, 0.5, 1.1, {}));
    rule = rule_of(RagdollCondition::depth_speed);
    rule.depth_speed = 0.4;
    CHECK(ragdoll_holds(rule, 0, 0, {0.4, 1}));
}

TEST_CASE("The hip has the mean height of the particles in contact, and only of them") {
    MadeUpWater water;
    water.add(50.1, 25, 100, -1, 0);
    water.add(49.9, 25.1, 300, -3, 0.5);  // three times the mass counts once all the same
    water.add(50.26, 25, 100, 9, 9);      // beyond 0.25 m
    water.py = {0.25F, 0.75F, 7};
    water.vy = {0.5F, -0.25F, 9};
    const auto ragdolls = ragdolls_of(tumbling_scene(RagdollCondition::paper), water);
    REQUIRE(ragdolls.size() == 1);
    CHECK(ragdolls[0].id == 0);
    CHECK(ragdolls[0].hip_height == 0.5);
    const Vector3d mean(-2, 0.125, 0.25), more = random_rate(false, 1, 0);
    for (int axis = 0; axis < 3; ++axis) {
        CHECK(ragdolls[0].rate[static_cast<std::size_t>(axis)] == Approx(mean[axis] + more[axis]).epsilon(1e-12));
        CHECK(more[axis] >= 0.1);
        CHECK(more[axis] < 0.5);
    }
}

TEST_CASE("Heights follow mirrored, scaled and shifted axes") {
    MadeUpWater water;
    water.add(0.1, 25, 100, 0, 0);  // stored x is the world's y, in half metres upside down from 3 m
    water.px = {4};
    water.vx = {1};
    water.py = {100};  // world x 50
    shm::StreamInfo info;
    info.axes = {2, -1, 3};
    info.metres_per_unit = 0.5;
    info.origin = {0, 3, 12.5};
    WaterBins bins;
    bins.grid = GroundGrid::over(World{});
    bins.with_heights = true;
    const Vector2d agent(50, 25);
    bin_water(bins, ground_view(water.frame(1), info), std::vector<Vector2d>{agent});
    const TouchingMean mean = mean_of_touching(bins, agent, 0.25);
    CHECK(mean.count == 1);
    CHECK(mean.height == 1);
    CHECK(mean.velocity[1] == -0.5);
}

TEST_CASE("Without a particle in contact there is no ragdoll") {
    MadeUpWater water;
    water.add(50.5, 25, 4000, -3, 0);  // in the agent's cell: 1 m deep, 3 m/s
    for (const auto condition :
         {RagdollCondition::paper, RagdollCondition::local_speed, RagdollCondition::depth_speed}) {
        CHECK(ragdolls_of(tumbling_scene(condition), water).empty());
        MadeUpWater closer = water;
        closer.px[0] = 50.2F;
        CHECK(ragdolls_of(tumbling_scene(condition), closer).size() == 1);
    }
}

TEST_CASE("v_F is that of the time of the step") {
    Scene scene = tumbling_scene(RagdollCondition::paper);
    scene.channel->velocity_history = {{0, 1}, {2.0, 3}};  // 2 m/s after a second
    CrowdWorld crowd = make_crowd(scene);
    const MadeUpWater water = uniform_water(40, 60, 15, 35, 1, 0.2, -1, 0);
    for (int i = 0; i < 31; ++i) step(crowd, water.view());
    CHECK(crowd.ragdolls.empty());
    for (int i = 0; i < 7; ++i) step(crowd, water.view());  // the condition must hold for 0.2 s
    CHECK(crowd.ragdolls.size() == 1);
}

TEST_CASE("Rows do not come and go with single particles, and neither hip nor rates jump, at any rate") {
    for (const double rate : {10.0, 30.0, 60.0}) {
        CAPTURE(rate);
        Tumbling tumbling;
        std::vector<bool> there;
        double height = 0, velocity = 0;
        const auto touch = [](std::uint64_t i, bool once) -> TouchingMean {
            if (once ? i != 0 : counter_uniform(1, 2, i) < 0.3) return {};
            return {1, counter_uniform(1, 3, i) < 0.5 ? 0.25 : 0.75, {-2 - counter_uniform(1, 4, i), 0, 0}};
        };
        for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(20 * rate); ++i) {
            tumble_on(tumbling, touch(i, false), 1 / rate);
            if (!there.empty() && there.back()) {  // what its aims, half a metre and 1 m/s apart, allow
                CHECK(std::abs(tumbling.height.value - height) <= ragdoll_pace * 0.5 / std::exp(1.0) / rate);
                CHECK(std::abs(tumbling.velocity.value.x() - velocity) <= ragdoll_pace / std::exp(1.0) / rate);
            }
            height = tumbling.height.value;
            velocity = tumbling.velocity.value.x();
            there.push_back(tumbling.enabled.holds);
        }
        // A third of the steps has no particle. After the first second 95 % of the rows are there, in few pieces.
        const auto begin = there.begin() + static_cast<std::ptrdiff_t>(rate);
        CHECK(static_cast<double>(std::count(begin, there.end(), true)) >= 0.95 * 19 * rate);
        int pieces = 0;
        for (auto at = begin + 1; at != there.end(); ++at) pieces += *at && !*(at - 1) ? 1 : 0;
        CHECK(pieces <= 3);

        Tumbling once;
        for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(rate); ++i) {
            tumble_on(once, touch(i, true), 1 / rate);
            CHECK_FALSE(once.enabled.holds);
        }
    }
}

TEST_CASE("The random part is uniform in [0.1, 0.5), with a sign only if asked for") {
    constexpr int draws = 30000;
    for (const bool random_sign : {false, true}) {
        double sum = 0, least = 1, most = 0;
        int negative = 0;
        for (std::uint32_t i = 0; i < draws / 3; ++i) {
            for (const double rate : random_rate(random_sign, 7, i)) {
                sum += std::abs(rate);
                least = std::min(least, std::abs(rate));
                most = std::max(most, std::abs(rate));
                negative += rate < 0 ? 1 : 0;
            }
        }
        CHECK(least >= 0.1);
        CHECK(most < 0.5);
        // Five standard errors: 0.4 / sqrt(12 n) for the mean, sqrt(n) / 2 for the count.
        CHECK(sum / draws == Approx(0.3).margin(5 * 0.4 / std::sqrt(12.0 * draws)));
        CHECK(std::abs(negative - (random_sign ? draws / 2 : 0)) <= (random_sign ? 2.5 * std::sqrt(draws) : 0));
    }
}

TEST_CASE("A draw depends on seed, agent and axis alone") {
    const Vector3d rate = random_rate(false, 1, 2);
    CHECK(rate == random_rate(false, 1, 2));
    CHECK(rate != random_rate(false, 2, 2));
    CHECK(rate != random_rate(false, 1, 3));
    CHECK(rate[0] != rate[1]);
    CHECK(rate[1] != rate[2]);
}

TEST_CASE("A scene without ragdolls keeps no heights and walks the same bits") {
    const MadeUpWater water = uniform_water(40, 60, 15, 35, 1, 0.2, -2.5, 0.1);
    CrowdWorld without = make_crowd(tumbling_scene(RagdollCondition::off));
    CrowdWorld with = make_crowd(tumbling_scene(RagdollCondition::paper));
    for (int i = 0; i < 30; ++i) {
        step(without, water.view());
        step(with, water.view());
    }
    CHECK(without.water.y.empty());
    CHECK(without.water.vy.empty());
    CHECK(without.ragdolls.empty());
    CHECK_FALSE(with.ragdolls.empty());
    CHECK(without.agents.position[0] == with.agents.position[0]);
}
