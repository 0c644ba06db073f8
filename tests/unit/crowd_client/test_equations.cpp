// Each equation of the model against a calculation by hand.

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "configs/scene/crowd.hpp"
#include "crowd_client/equations.hpp"

using namespace wade;
using namespace wade::crowd;

namespace {
// A few roundings of numbers of order one to a thousand.
Approx close_to(double v) {
    return Approx(v).epsilon(1e-14).margin(1e-14);
}
}  // namespace

TEST_CASE("Eq. 1: the motion vector is the weighted sum of the ways to the markers", "[eq1]") {
    const std::array<double, 3> w{0.5, 0.25, 0.25};
    const std::array<Vector2d, 3> a{Vector2d(1, 0), Vector2d(0, 2), Vector2d(-1, 1)};
    const Vector2d m = motion_vector(w, a);
    CHECK(m.x() == close_to(0.5 * 1 + 0.25 * 0 + 0.25 * -1));
    CHECK(m.y() == close_to(0.25 * 2 + 0.25 * 1));
    CHECK(motion_vector({}, {}) == Vector2d(0, 0));
}

TEST_CASE("Eq. 2: a weight is the share of a marker in the sum of the preferences", "[eq2]") {
    CHECK(marker_weight(1.5, 6) == close_to(0.25));
    CHECK(marker_weight(0, 6) == 0);
    CHECK(marker_weight(0, 0) == 0);
}

TEST_CASE("Eq. 3: markers in the direction of the goal and near ones are preferred", "[eq3]") {
    const Vector2d goal(10, 0);
    CHECK(marker_preference(goal, {1, 0}) == close_to(2 / 2.0));        // ahead, 1 m
    CHECK(marker_preference(goal, {0, 1}) == close_to(1 / 2.0));        // abreast, 1 m
    CHECK(marker_preference(goal, {-1, 0}) == close_to(0));             // behind
    CHECK(marker_preference(goal, {0.3, 0.4}) == close_to(1.6 / 1.5));  // cos = 0.6, 0.5 m
    CHECK(marker_preference({-4, -3}, {-0.8, -0.6}) == close_to(1.0));  // ahead in another direction
}

TEST_CASE("Eq. 3: neither an agent on its goal nor a marker under the agent divides by zero", "[eq3]") {
    CHECK(marker_preference({0, 0}, {0.6, 0.8}) == close_to(0.5));
    CHECK(marker_preference({3, 0}, {0, 0}) == close_to(1.0));
    CHECK(marker_preference({0, 0}, {0, 0}) == close_to(1.0));
}

TEST_CASE("Eq. 4: each reading of the speed rule limits the speed as it says", "[eq4]") {
    const double s_max = 1.3;
    const double dt = 1.0 / 30;
    const Vector2d m(0.03, 0.04);  // |m| = 0.05 m, direction (0.6, 0.8)

    const Vector2d by_pi = walking_velocity(m, s_max, SpeedRule::pi, dt);
    CHECK(by_pi.x() == close_to(0.6 * std::numbers::pi * 0.05 * 1.3));
    CHECK(by_pi.y() == close_to(0.8 * std::numbers::pi * 0.05 * 1.3));
    CHECK(walking_velocity({0.3, 0.4}, s_max, SpeedRule::pi, dt).norm() == close_to(1.3));  // pi 0.5 > 1

    CHECK(walking_velocity(m, s_max, SpeedRule::per_frame, dt).norm() == close_to(1.3));  // 0.05 m > 1.3 / 30 m
    CHECK(walking_velocity(m / 5, s_max, SpeedRule::per_frame, dt).norm() == close_to(0.01 * 30));

    CHECK(walking_velocity(m, s_max, SpeedRule::per_second, dt).norm() == close_to(0.05));
    CHECK(walking_velocity({3, 4}, s_max, SpeedRule::per_second, dt).norm() == close_to(1.3));
}

TEST_CASE("Eq. 4: without a motion vector the agent stands", "[eq4]") {
    for (const SpeedRule rule : {SpeedRule::pi, SpeedRule::per_frame, SpeedRule::per_second}) {
        CHECK(walking_velocity({0, 0}, 1.3, rule, 1.0 / 30) == Vector2d(0, 0));
    }
}

TEST_CASE("Eq. 5: the water in contact carries the sum of its particles' momenta", "[eq5]") {
    const std::array<WaterParticle, 2> particles{WaterParticle{100, {-1.5, 0.25}}, WaterParticle{50, {-1, 0.5}}};
    const Contact water = contact_momentum(particles);
    CHECK(water.mass == close_to(150));
    CHECK(water.momentum.x() == close_to(-200));
    CHECK(water.momentum.y() == close_to(50));
    CHECK(contact_momentum({}).mass == 0);
}

TEST_CASE("Eq. 6: the momentum before the collision is that of the agent and of the water", "[eq6]") {
    const Vector2d p = momentum_before(65, {0, 1.3}, {150, {-200, 50}});
    CHECK(p.x() == close_to(-200));
    CHECK(p.y() == close_to(65 * 1.3 + 50));
}

TEST_CASE("Eq. 7: agent and water go on as one mass", "[eq7]") {
    CHECK(mass_after(65, {150, {-200, 50}}) == close_to(215));
}

TEST_CASE("Eq. 8: an agent yields to the share tau of the water", "[eq8]") {
    const Contact yielded = yielded_water(0.2, {150, {-200, 50}});
    CHECK(yielded.mass == close_to(30));
    CHECK(yielded.momentum.x() == close_to(-40));
    CHECK(yielded.momentum.y() == close_to(10));
}

TEST_CASE("Eq. 9: the new velocity is the common one of the agent and the water it yields to", "[eq9]") {
    const Vector2d v = coupled_velocity(65, {0, 1.3}, 0.2, {150, {-200, 50}});
    CHECK(v.x() == close_to(-40.0 / 95));
    CHECK(v.y() == close_to((84.5 + 10) / 95));
    // tau = 1 is the plain inelastic collision.
    CHECK(coupled_velocity(65, {0, 1.3}, 1, {150, {-200, 50}}).x() == close_to(-200.0 / 215));
}

TEST_CASE("Eq. 9: without endurance lost or without water the agent walks on, bit for bit", "[eq9]") {
    const Vector2d walking(0.123456789, -1.1111);
    CHECK(coupled_velocity(65, walking, 0, {150, {-200, 50}}) == walking);
    CHECK(coupled_velocity(65, walking, 1, {}) == walking);
}

TEST_CASE("A direction has the length 1, however small the vector, or there is none") {
    const Vector2d none(0, 0);
    for (double length = 1e10; length > 1e-320; length *= 0.37) {
        const Vector2d unit = unit_or(length * Vector2d(0.985, 0.17), none);
        CHECK((unit == none || std::abs(unit.norm() - 1) < 1e-15));
        CHECK((length < 1e-150 || unit != none));
    }
}
