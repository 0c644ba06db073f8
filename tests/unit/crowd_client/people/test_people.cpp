#include <catch2/catch.hpp>
#include <cmath>

#include "crowd_client/people/people.hpp"

using namespace wade;
using namespace wade::crowd;

namespace {

People one_person(const BodySettings& body = {}) {
    People people;
    AgentGroup group;
    group.body = body;
    add_person(people, group, {}, true, {0.9, 0.5, 0.5, 0.5});
    return people;
}

}  // namespace

TEST_CASE("What people feel is low-passed with 0.3 s, the same at any rate") {
    for (const double rate : {15.0, 30.0, 240.0}) {
        People people = one_person();
        feel(people, 0, {0, {0, 0}, 1 / rate, true});
        for (int i = 0; i < static_cast<int>(rate); ++i) feel(people, 0, {1, {-2, 0}, 1 / rate, false});
        CHECK(people.depth[0] == Approx(1 - std::exp(-1 / 0.3)));
        CHECK(mean_stream(people, 0).x() == Approx(-2));
    }
}

TEST_CASE("What people feel first they feel as it is, and dry ground at last is dry") {
    People people = one_person();
    feel(people, 0, {1, {-2, 0}, 1 / 30.0, true});
    CHECK(people.depth[0] == 1);
    for (int i = 0; i < 300; ++i) feel(people, 0, {0, {0, 0}, 1 / 30.0, false});
    CHECK(people.depth[0] == 0);
    CHECK(mean_stream(people, 0) == Vector2d(0, 0));
}

TEST_CASE("Skills are pairs of friction and arm, and a friction of the ground takes the place of the first") {
    for (const Skill skill : {Skill::braced, Skill::good, Skill::normal, Skill::unaware, Skill::poor}) {
        BodySettings body;
        body.skill = skill;
        const People people = one_person(body);
        CHECK(people.friction[0] == bracing_of(skill).friction);
        CHECK(people.arm[0] == Approx(1.7 * bracing_of(skill).arm_share));
        body.ground_friction = 0.2;
        CHECK(one_person(body).friction[0] == 0.2);
        CHECK(one_person(body).arm[0] == people.arm[0]);
    }
}

TEST_CASE("Speeds by age are Bernardini's, and never above that on dry ground") {
    BodySettings body;
    body.age = 30;
    People people = one_person(body);
    const auto speed = [&](double depth) {
        feel(people, 0, {depth, {0, 0}, 1, true});
        return speed_in_water(people, 0, WalkingLaw::bernardini, 9.81);
    };
    CHECK(speed(0) == 1.3);
    CHECK(speed(0.001) == 1.3);
    CHECK(speed(0.35) == Approx(0.35 * std::pow(0.5 * 0.35 * 0.35, -0.19)));
    people.age[0] = 78;
    CHECK(speed(0.35) == Approx(0.16 * std::pow(0.5 * 0.35 * 0.35, -0.43) / 1.16));
}
