// The rule `continuous`: agents tend to the velocity of Eq. 9, for steps of any length.

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "crowd_client/crowd_world.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::one_agent_scene;

namespace {

constexpr double body_mass = 65;
const Vector2d walking(0.2, 1.25);

Contact contact_of(double its_mass, const Vector2d& velocity) {
    return {its_mass, its_mass * velocity};
}

// Contact mass that comes and goes, as particles do: 196 kg on average, three periods, none a multiple of another.
Contact fluctuating(double t) {
    constexpr double two_pi = 2 * std::numbers::pi;
    const double wave = std::sin(two_pi * 1.3 * t) + std::sin(two_pi * 3.1 * t) + std::sin(two_pi * 7.7 * t);
    return contact_of(196 * (1 + 0.3 * wave), {-1.5 + 0.2 * std::cos(two_pi * 2.1 * t), 0.1});
}

// Where an agent is after 4 s that walks steadily through the fluctuating water.
Vector2d place_after_4_s(double rate) {
    Vector2d x = Vector2d::Zero(), v = Vector2d::Zero();
    const int steps = static_cast<int>(std::lround(4 * rate));
    for (int k = 1; k <= steps; ++k) {
        const RelaxedVelocity step = relaxed_velocity(body_mass, v, walking, 0.8, fluctuating(k / rate), 1 / rate);
        v = step.at_end;
        x += step.mean / rate;
    }
    return x;
}

}  // namespace

TEST_CASE("In constant water the steady state is that of Eq. 9 at any rate", "[eq9]") {
    for (const double tau : {0.0, 0.2, 1.0}) {
        for (const double contact : {0.0, 100.0, 196.0, 1767.0}) {
            const Contact water = contact_of(contact, {-2.5, 0.3});
            const Vector2d expected = coupled_velocity(body_mass, walking, tau, water);
            for (const double rate : {1.0, 15.0, 30.0, 60.0, 120.0, 1000.0}) {
                Vector2d v(3, -3);
                // Two seconds are 60 T: what is left of the start is below 1e-25 of it.
                for (int k = 0; k < 2 * rate; ++k)
                    v = relaxed_velocity(body_mass, v, walking, tau, water, 1 / rate).at_end;
                CHECK(v.x() == Approx(expected.x()).margin(1e-12));
                CHECK(v.y() == Approx(expected.y()).margin(1e-12));
            }
        }
    }
}

TEST_CASE("In constant water velocity and path after a jump are the same for steps of any length", "[eq9]") {
    const Contact water = contact_of(150, {-1.5, 0});
    const RelaxedVelocity once = relaxed_velocity(body_mass, {1, 1}, walking, 0.3, water, 1.0 / 15);
    for (const int steps : {2, 4, 8, 1000}) {
        const double dt = 1.0 / 15 / steps;
        Vector2d v(1, 1), way = Vector2d::Zero();
        for (int k = 0; k < steps; ++k) {
            const RelaxedVelocity step = relaxed_velocity(body_mass, v, walking, 0.3, water, dt);
            v = step.at_end;
            way += step.mean * dt;
        }
        CHECK((v - once.at_end).norm() < 1e-12);
        CHECK((way - once.mean / 15).norm() < 1e-12);
    }
}

TEST_CASE("From rest the velocity tends to v_inf with a time of 1/30 s, and ends 1/30 s behind it", "[eq9]") {
    const Contact water = contact_of(150, {-1.5, 0});
    const Vector2d steady = coupled_velocity(body_mass, walking, 0.3, water);
    const auto from_rest = [&](double dt) { return relaxed_velocity(body_mass, {0, 0}, walking, 0.3, water, dt); };
    // 1 - 1/e, 1 - e^-0.25 and 1 - e^-2.
    for (const auto& [dt, share] : {std::pair{1.0 / 30, 0.6321205588285577}, std::pair{1.0 / 120, 0.2211992169285951},
                                    std::pair{1.0 / 15, 0.8646647167633873}}) {
        CHECK((from_rest(dt).at_end - share * steady).norm() < 1e-12);
    }
    // Over 2 s, 60 of these times, an agent of Eq. 9 goes 2 s v_inf, this one 2 s - 1/30 s = 1.9666... s.
    CHECK((2 * from_rest(2).mean - 1.9666666666666667 * steady).norm() < 1e-12);
}

TEST_CASE("In water that fluctuates the mean velocity is that of Eq. 9 for steps of any length", "[eq9]") {
    // Of so many steps that the start, which lasts for T, does not matter: T / 1000 s times 3 m/s is 1e-4 m/s.
    for (const double rate : {7.5, 15.0, 30.0, 120.0}) {
        Vector2d v = Vector2d::Zero(), mean = Vector2d::Zero(), expected = Vector2d::Zero();
        const int steps = static_cast<int>(1000 * rate);
        for (int k = 1; k <= steps; ++k) {
            const Contact water = fluctuating(k / rate);
            const RelaxedVelocity step = relaxed_velocity(body_mass, v, walking, 0.8, water, 1 / rate);
            v = step.at_end;
            mean += step.mean / steps;
            expected += coupled_velocity(body_mass, walking, 0.8, water) / steps;
        }
        CHECK((mean - expected).norm() < 2e-4);
    }
}

TEST_CASE("Without water or with tau 0 the velocity tends to that of walking, without overshoot", "[eq9]") {
    for (const auto& [tau, contact] : {std::pair{0.0, 500.0}, std::pair{1.0, 0.0}}) {
        Vector2d v = Vector2d::Zero();
        for (int k = 0; k < 20; ++k) {
            const Vector2d next =
                relaxed_velocity(body_mass, v, walking, tau, contact_of(contact, {-9, 0}), 1.0 / 30).at_end;
            CHECK(next.y() > v.y());
            CHECK(next.y() <= walking.y());
            v = next;
        }
        CHECK(v.y() == Approx(walking.y()).epsilon(1e-8));  // exp(-20)
    }
}

TEST_CASE("In water that fluctuates, paths converge as the steps get shorter", "[eq9]") {
    const Vector2d best = place_after_4_s(15 * 1024);
    double before = 0;
    for (const double rate : {60.0, 120.0, 240.0, 480.0}) {
        const double error = (place_after_4_s(rate) - best).norm();
        INFO(rate << " steps a second: " << error << " m");
        // First order: half the step, half the error, up to terms of second order.
        if (before > 0) CHECK(before / error == Approx(2).margin(0.4));
        before = error;
    }
    CHECK(before < 0.005);  // of some 4 m
}

TEST_CASE("A crowd with the rule takes its velocity from the one before, from its walk and from the water it meets") {
    for (const double rate : {15.0, 30.0, 120.0}) {
        Scene scene = one_agent_scene(50, 25, 50.001, 49, 0.4);
        scene.coupling->rule = CouplingRule::continuous;
        scene.frame_rate = scene.crowd->step_rate = rate;
        CrowdWorld crowd = make_crowd(scene);
        const MadeUpWater water = testing::uniform_water(44, 54, 20, 35, 1, 0.25, -0.5, 0);
        for (int k = 0; k < rate; ++k) {
            const Vector2d before = crowd.agents.momentary[0];
            step(crowd, water.view());
            const RelaxedVelocity expected =
                relaxed_velocity(body_mass, before, crowd.walking[0], 0.4, crowd.contacts[0], 1 / rate);
            REQUIRE(crowd.agents.momentary[0] == expected.at_end);
            // The velocity is a difference of positions of 50 m, so that their rounding limits it.
            REQUIRE((crowd.agents.velocity[0] - expected.mean).norm() < 1e-11);
        }
        CHECK(crowd.agents.position[0].x() < 50);
    }
}

TEST_CASE("A velocity that meets a wall goes on along it") {
    Scene scene = one_agent_scene(50, 25, 50.001, 49, 1);
    scene.coupling->rule = CouplingRule::continuous;
    scene.obstacles.push_back({{46, 49}, {10, 45}, 1});
    CrowdWorld crowd = make_crowd(scene);
    const MadeUpWater water = testing::uniform_water(44, 54, 20, 45, 1, 0.25, -2, 0.5);
    bool met = false;
    for (int k = 0; k < 60; ++k) {
        const double x_before = crowd.agents.position[0].x();
        step(crowd, water.view());
        const Vector2d& v = crowd.agents.momentary[0];
        const bool at_wall = crowd.agents.position[0].x() < 49.00001;
        if (at_wall) CHECK(v.x() == 0);
        if (at_wall && met) CHECK(crowd.agents.position[0].x() == x_before);
        CHECK(v.y() > 0);
        met = met || at_wall;
    }
    CHECK(met);
}
