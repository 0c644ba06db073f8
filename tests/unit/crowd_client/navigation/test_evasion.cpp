#include <catch2/catch.hpp>
#include <vector>

#include "configs/scene/crowd.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/navigation/evasion.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::one_agent_scene;
using wade::crowd::testing::uniform_water;

namespace {

// Where an agent at (50, 25) that goes to z = 50 looks.
Vector2d offset_in(const MadeUpWater& water, const EvasionSettings& settings) {
    CrowdWorld crowd = make_crowd(one_agent_scene(50, 25, 50, 50, 0));
    const std::vector<Vector2d> places{{50, 25}};
    bin_water(crowd.water, water.view(), places);
    std::vector<Vector2d> offsets{{0, 25}};
    evade(settings, crowd.agents, crowd.active, places, crowd.water, offsets);
    return offsets[0];
}

MadeUpWater one_particle(double x, double z, double vx, double vz) {
    MadeUpWater water;
    water.add(x, z, 100, vx, vz);
    return water;
}

}  // namespace

TEST_CASE("flee: the goal's direction gives way to that away from the water within the radius") {
    const EvasionSettings flee{EvasionRule::flee, 2, 1};
    Vector2d o = offset_in(one_particle(50.6, 25.8, -3, 0), flee);
    CHECK(o.x() / o.y() == Approx(0.75));
    CHECK(o.x() < 0);
    o = offset_in(one_particle(51.3, 26.6, -3, 0), flee);  // 2.06 m away
    CHECK((o.x() == 0 && o.y() == 25));
}

TEST_CASE("evasion: away from where the water will be after distance / desired speed, at most the prediction") {
    // 1.3 m away, desired speed 1.3 m/s: T = 1 s.
    const MadeUpWater water = one_particle(51.3, 25, 0, 0.65);
    Vector2d o = offset_in(water, {EvasionRule::evasion, 2, 10});
    CHECK(o.y() / o.x() == Approx(0.5).epsilon(1e-6));
    CHECK(o.x() < 0);
    o = offset_in(water, {EvasionRule::evasion, 2, 0.5});
    CHECK(o.y() / o.x() == Approx(0.25).epsilon(1e-6));
}

TEST_CASE("who has water all round goes on towards the goal; dry ground changes nothing") {
    const EvasionSettings flee{EvasionRule::flee, 2, 1};
    CHECK(offset_in(uniform_water(45, 55, 20, 30, 1, 0.25, -1, 0), flee) == Vector2d(0, 25));
    CHECK(offset_in(one_particle(80, 25, 0, 0), flee) == Vector2d(0, 25));
}

TEST_CASE("people step back from the front where evasion is on, and walk into the water where it is off") {
    const auto walk = [](EvasionRule rule) {
        Scene scene = one_agent_scene(50, 8, 50, 50, 0);
        scene.crowd->evasion.rule = rule;
        CrowdWorld crowd = make_crowd(scene);
        double furthest = -100;
        for (int frame = 0; frame < 240; ++frame) {
            // From z = 14 on the front advances towards the agents at 0.5 m/s.
            const double front = 14 - 0.5 * frame / 30;
            step(crowd, uniform_water(40, 60, front, 30, 1, 0.25, 0, -0.5).view());
            furthest = std::max(furthest, crowd.agents.position[0].y() - front);
        }
        return furthest;
    };
    CHECK(walk(EvasionRule::off) > 0.5);
    CHECK(walk(EvasionRule::flee) < 0);
    CHECK(walk(EvasionRule::evasion) < 0);
}
