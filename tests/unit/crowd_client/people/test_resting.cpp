// How firmly bodies rest on the ground in the postures of getting up.

#include <array>
#include <catch2/catch.hpp>

#include "configs/scene/crowd.hpp"
#include "crowd_client/people/people.hpp"
#include "crowd_client/people/resting.hpp"
#include "crowd_client/people/states.hpp"

using namespace wade;
using namespace wade::crowd;

namespace {

// The demands of a person of a skill at rest in a stream.
Strain at_rest(const Body& person, Skill skill, double depth, double speed) {
    const Bracing bracing = bracing_of(skill);
    Strain strain;
    strain.height = person.height;
    strain.depth = depth;
    for (std::size_t n = 0; n < rests; ++n) {
        const Stance stance =
            stance_of(static_cast<Rest>(n), person, bracing.friction, bracing.arm_share * person.height, depth, {});
        strain.at_rest[n] = demand_at_rest(stance, depth, Vector2d(speed, 0));
    }
    return strain;
}

// Returns the fastest stream, m/s, that lets a drifting person come to rest.
double fastest_stop(const Body& person, Skill skill, double depth) {
    double lo = 0, hi = 20;
    for (int i = 0; i < 50; ++i) {
        const double speed = 0.5 * (lo + hi);
        Condition condition;
        condition.state = PersonState::carried;
        const Condition next = next_condition(condition, at_rest(person, skill, depth, speed), 0.1);
        (next.state == PersonState::carried ? hi : lo) = speed;
    }
    return lo;
}

}  // namespace

// Worked out by hand from the table of resting.hpp.
TEST_CASE("The water takes weight off a body of 1.7 m and 70 kg by its posture") {
    struct Row {
        double depth, speed;
        Rest posture;
        double weight, drag, slip, topple;
    };
    const Row row =
        GENERATE(Row{1, 1, Rest::sits, 32.7, 173.6, 11.8, 5.5}, Row{1, 1, Rest::kneels, 173, 149.6, 1.92, 1.69},
                 Row{0.8, 1.2, Rest::sits, 75, 226, 6.7, 2.8}, Row{0.6, 1.5, Rest::sits, 175, 265, 3.4, 1.07},
                 Row{0.6, 1.5, Rest::stands, 557, 202, 0.81, 0.71});
    CAPTURE(row.depth, row.speed, static_cast<int>(row.posture));
    const Stance stance = stance_of(row.posture, {1.7, 70}, 0.45, 0.09 * 1.7, row.depth, {});
    const double drag = stance.k * row.speed * row.speed;
    CHECK(stance.weight == Approx(row.weight).epsilon(0.02));
    CHECK(drag == Approx(row.drag).epsilon(0.02));
    CHECK(drag / (stance.friction * stance.weight) == Approx(row.slip).epsilon(0.03));
    CHECK(0.5 * drag * stance.wet / (stance.weight * stance.arm) == Approx(row.topple).epsilon(0.05));
}

TEST_CASE("A body wholly under water has its buoyant weight in each posture, and dry ground has no demand") {
    const auto posture = static_cast<Rest>(GENERATE(0, 1, 2, 3));
    CHECK(stance_of(posture, {1.7, 65}, 0.45, 0.15, 1.7, {}).weight == Approx(65 * 9.81 * (1 - 1000.0 / body_density)));
    CHECK(stance_of(posture, {1.7, 65}, 0.45, 0.15, 0, {}).weight == Approx(65 * 9.81));
    CHECK(demand_at_rest(stance_of(posture, {1.7, 65}, 0.45, 0.15, 0, {}), 0, Vector2d(0, 0)) == 0);
}

TEST_CASE("The fastest stream in which a drifting person comes to rest never grows with the depth") {
    const Body person = GENERATE(Body{1.7, 70}, Body{1.85, 110}, Body{1.1, 19});
    const Skill skill = GENERATE(Skill::braced, Skill::good, Skill::normal, Skill::unaware, Skill::poor);
    double before = 20;
    for (double depth = 0.02; depth < 1.2 * person.height; depth += 0.01) {
        const double stop = fastest_stop(person, skill, depth);
        CAPTURE(person.height, static_cast<int>(skill), depth, stop, before);
        CHECK(stop <= before + 1e-9);
        before = stop;
    }
    CHECK(before == Approx(0).margin(1e-6));
}

TEST_CASE("A person of normal skill does not come to rest in a stream of 1 m at 1 m/s") {
    CHECK(fastest_stop({1.7, 70}, Skill::normal, 1) < 1);
}
