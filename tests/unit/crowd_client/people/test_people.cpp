#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "configs/scene/crowd.hpp"
#include "crowd_client/people/people.hpp"

using namespace wade;
using namespace wade::crowd;

namespace {

// The worked example: 1.70 m, 65 kg, mu 0.45, lambda 0.09.
constexpr Body body{1.7, 65};
constexpr double friction = 0.45, arm = 0.09 * 1.7;
constexpr WaterProperties fresh_water;

struct Demands {
    double slip, topple;
};

Demands demands(double depth, double speed) {
    const double k = drag_upright(body.height, depth, fresh_water);
    const double weight = weight_on_feet(body, depth, fresh_water);
    return {slip_demand(k, {-speed, 0}, Vector2d::Zero(), friction, weight),
            topple_demand(k, {-speed, 0}, depth, weight, arm)};
}

Footing footing(double depth) {
    const double share = submerged_share(body.height, depth);
    return {drag_upright(body.height, depth, fresh_water), mass_with_water(body.mass, share, fresh_water),
            friction * weight_on_feet(body, depth, fresh_water)};
}

struct Walk {
    Vector2d place = Vector2d::Zero(), velocity = Vector2d::Zero(), impulses = Vector2d::Zero();
    bool slides = false;
};

// Ten seconds in 1 m of water.
Walk walk(double rate, double stream, double wanted) {
    const Footing feet = footing(1);
    Walk at;
    for (int i = 0; i < static_cast<int>(10 * rate); ++i) {
        const PersonStep step = step_on_feet(feet, at.velocity, {0, wanted}, {-stream, 0}, 1 / rate);
        at.velocity = step.velocity;
        at.place += step.velocity / rate;
        at.impulses += step.ground + step.drag;
        at.slides = step.slides;
    }
    return at;
}

constexpr std::array rates{15.0, 30.0, 60.0, 240.0};

People one_person(const BodySettings& settings = {}) {
    People people;
    AgentGroup group;
    group.body = settings;
    add_person(people, group, {}, true, {0.9, 0.5, 0.5, 0.5, 0.5});
    return people;
}

}  // namespace

TEST_CASE("Slip and topple demand are those of the worked example") {
    struct Row {
        double depth, speed, slip, topple;
    };
    const Row row = GENERATE(Row{0.5, 0.5, 0.08, 0.06}, Row{0.5, 1.5, 0.69, 0.51}, Row{0.5, 2.5, 1.93, 1.42},
                             Row{0.7, 1.0, 0.48, 0.50}, Row{0.7, 2.0, 1.94, 1.99}, Row{0.7, 2.5, 3.03, 3.115},
                             Row{1.0, 0.5, 0.22, 0.33}, Row{1.0, 1.0, 0.89, 1.31}, Row{1.0, 2.5, 5.56, 8.18},
                             Row{1.2, 0.5, 0.35, 0.61}, Row{1.2, 1.0, 1.38, 2.44}, Row{1.2, 1.5, 3.11, 5.49});
    CAPTURE(row.depth, row.speed);
    constexpr double rounding = 0.0051;  // of the table, two decimals
    CHECK(std::abs(demands(row.depth, row.speed).slip - row.slip) < rounding);
    CHECK(std::abs(demands(row.depth, row.speed).topple - row.topple) < rounding);
}

TEST_CASE(
    "The fastest water in which people keep their footing, and what the feet hold near it, change without a step") {
    struct Row {
        double depth, speed;
    };
    const Row row = GENERATE(Row{0.025, 4}, Row{0.05, 2}, Row{0.16, 2}, Row{0.18, 2.5}, Row{0.2, 3}, Row{1.5, 3});
    CAPTURE(row.depth);
    CHECK(fastest_footing(row.depth) == Approx(row.speed));
    CHECK(rush_demand(row.depth, {0, row.speed}) == Approx(1));
    const double k = drag_upright(1.7, row.depth, {}), grip = 1e4;
    const auto held = [&](double speed) { return grip_in_stream(grip, k, row.depth, {speed, 0}); };
    CHECK(held(0) == grip);
    CHECK(held(std::sqrt(0.8) * row.speed) == Approx(grip));
    CHECK(held(row.speed) == Approx(k * row.speed * row.speed));
    CHECK(held(2 * row.speed) == held(row.speed));
    double before = grip;
    for (double speed = 0; speed < row.speed; speed += 0.01) {
        CHECK(held(speed) <= before);
        CHECK(held(speed) >= k * speed * speed);  // no one slips before
        before = held(speed);
    }
    CHECK(grip_in_stream(10, k, 1.5, {3, 0}) == 10);
}

TEST_CASE("In a metre of water feet carry 373.5 N of 65 kg, and nothing where the body floats") {
    CHECK(weight_on_feet(body, 1, fresh_water) == Approx(373.5).margin(0.05));
    CHECK(weight_on_feet(body, 0, fresh_water) == Approx(65 * 9.81));
    CHECK(weight_on_feet(body, 2, {1200, 9.81}) == 0);
    CHECK(slip_demand(100, {1, 0}, {0, 0}, friction, 0) > 1e300);
    CHECK(slip_demand(100, {0, 0}, {0, 0}, friction, 0) == 0);
}

TEST_CASE("Who stands in a stream slides as fast as friction and drag balance, with any step") {
    struct Row {
        double stream, slides, path;
    };
    const Row row = GENERATE(Row{1.5, 0.44000, 4.284}, Row{2.5, 1.44000, 0});
    for (const double rate : rates) {
        CAPTURE(row.stream, rate);
        const Walk at = walk(rate, row.stream, 0);
        CHECK(at.slides);
        CHECK(at.velocity.x() == Approx(-row.slides).margin(5e-6));
        CHECK(at.velocity.x() == Approx(-row.stream + std::sqrt(footing(1).grip / footing(1).k)).margin(1e-9));
        if (row.path > 0) CHECK(at.place.x() == Approx(-row.path).margin(1.5e-3));  // 4.283 at 15 Hz
    }
}

TEST_CASE("Who crosses a stream that it cannot hold drifts down it and walks slower, with any step") {
    for (const double rate : rates) {
        CAPTURE(rate);
        const Walk at = walk(rate, 1.5, 0.67);
        CHECK(at.velocity.x() == Approx(-0.53216).margin(5e-6));
        CHECK(at.velocity.y() == Approx(0.43230).margin(5e-6));
    }
}

TEST_CASE("Who crosses a stream that the feet hold walks as it wants") {
    for (const double rate : rates) {
        const Walk at = walk(rate, 0.5, 0.67);
        CHECK_FALSE(at.slides);
        CHECK(at.velocity.x() == Approx(0).margin(1e-12));
        CHECK(at.velocity.y() == Approx(0.67).margin(1e-9));
    }
}

TEST_CASE("The momentum of a person is the sum of the impulses of ground and water") {
    for (const double rate : rates) {
        const Walk at = walk(rate, 1.5, 0.67);
        CHECK((footing(1).mass * at.velocity - at.impulses).norm() < 1e-11);  // rounding of 2400 steps, N s
    }
}

TEST_CASE("On dry ground a step is that of the legs, and one of little grip is short of it") {
    const PersonStep firm = step_on_feet({0, 65, 1e6}, {0, 0}, {1.3, 0}, {0, 0}, 0.1);
    CHECK(firm.velocity.x() == Approx(1.3 * (1 - std::exp(-0.25))));
    const PersonStep icy = step_on_feet({0, 65, 20}, {0, 0}, {1.3, 0}, {0, 0}, 0.1);
    CHECK(icy.slides);
    CHECK(icy.velocity.x() == Approx(0.1 * 20 / 65));
}

TEST_CASE("A body without ground takes the speed of the water and never more, with steps of any length") {
    for (const double mass : {1.0, 65.0}) {
        for (const double dt : {1 / 30.0, 1.0, 100.0}) {
            Vector2d velocity(0, 0);
            for (int i = 0; i < 30; ++i) {
                const PersonStep step = step_carried(165, mass, velocity, {0, 0}, {1, 0}, dt);
                CHECK(step.velocity.x() >= velocity.x());
                CHECK(step.velocity.x() <= 1);
                velocity = step.velocity;
            }
        }
    }
}

TEST_CASE("A carried body reaches 0.9 of the water's speed after nine times M / (k U)") {
    constexpr double k = 165, mass = 92, time = 9 * mass / k;
    constexpr int steps = 2000;
    Vector2d velocity(0, 0);
    for (int i = 0; i < steps; ++i) velocity = step_carried(k, mass, velocity, {0, 0}, {1, 0}, time / steps).velocity;
    CHECK(velocity.x() == Approx(0.9).margin(1e-3));  // implicit Euler, 220 steps in each M / (k U)
}

TEST_CASE("A swimmer of 45 N in still water goes 0.45 m/s") {
    Vector2d velocity(0, 0);
    const double depth = 0.87 * body.height, k = drag_upright(body.height, depth, fresh_water);
    for (int i = 0; i < 3000; ++i) velocity = step_carried(k, 120, velocity, {45, 0}, {0, 0}, 1 / 30.0).velocity;
    CHECK(velocity.x() == Approx(0.45).margin(0.005));
}

TEST_CASE("The file's tau is the share that the feet do not hold") {
    CHECK(tau_of(0.5) == 0);
    CHECK(tau_of(1) == 0);
    CHECK(tau_of(4) == 0.75);
}

TEST_CASE("Walking speeds in still water are those measured at 0.35 m and fall with the depth") {
    struct Row {
        double depth, men, women;
    };
    const Row row = GENERATE(Row{0.2, 0.76, 0.68}, Row{0.35, 0.614, 0.552}, Row{0.5, 0.54, 0.48}, Row{0.6, 0.50, 0.45},
                             Row{0.9, 0.43, 0.39});
    CAPTURE(row.depth);
    constexpr double rounding = 0.0051;  // of the table
    CHECK(std::abs(walking_speed_ratio(Sex::male, row.depth, 0, 9.81) - row.men) < rounding);
    CHECK(std::abs(walking_speed_ratio(Sex::female, row.depth, 0, 9.81) - row.women) < rounding);
}

TEST_CASE("Shallow water does not slow people, and a stream does more than still water") {
    CHECK(walking_speed_ratio(Sex::male, 0.05, 0, 9.81) == 1);
    CHECK(walking_speed_ratio(Sex::male, 0, 3, 9.81) == 1);
    CHECK(walking_speed_ratio(Sex::male, 0.5, 1, 9.81) < walking_speed_ratio(Sex::male, 0.5, 0, 9.81));
}

// Li et al. 2024 measured 11.24 % more at 0.60 m and 4.85 % at 0.35 m of people along a rope; 0.16 of the drag is left in a file.
TEST_CASE("In a file people walk 9.2 % faster at 0.60 m and 5.8 % at 0.35 m, and not faster than on dry ground") {
    const auto gain = [](double depth, double drag_left) {
        People people = one_person();
        FeltStep felt{depth, Vector2d::Zero(), 1 / 30.0, true};
        feel(people, 0, felt);
        const double alone = speed_in_water(people, 0, 65, WalkingLaw::relative, {});
        felt.lee = 1 - std::sqrt(drag_left);
        feel(people, 0, felt);
        return speed_in_water(people, 0, 65, WalkingLaw::relative, {}) / alone - 1;
    };
    CHECK(gain(0.6, 0.16) == Approx(0.092).margin(0.001));
    CHECK(gain(0.35, 0.16) == Approx(0.058).margin(0.001));
    CHECK(std::abs(gain(0.6, 0.16) - 0.1124) < 0.022);  // what two points leave of one constant
    CHECK(std::abs(gain(0.35, 0.16) - 0.0485) < 0.011);
    CHECK(gain(0.6, 1) == 0);
    CHECK(gain(0.05, 0) == 0);
}

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

TEST_CASE("Skills are pairs of friction and arm, and a friction of the ground or an arm takes the place of either") {
    for (const Skill skill : {Skill::braced, Skill::good, Skill::normal, Skill::unaware, Skill::poor}) {
        BodySettings settings;
        settings.skill = skill;
        const People people = one_person(settings);
        CHECK(people.friction[0] == bracing_of(skill).friction);
        CHECK(people.arm[0] == Approx(1.7 * bracing_of(skill).arm_share));
        settings.ground_friction = 0.2;
        CHECK(one_person(settings).friction[0] == 0.2);
        CHECK(one_person(settings).arm[0] == people.arm[0]);
        settings.bracing_arm = 0.301;  // of Abt's people, by the fit of the observatory
        CHECK(one_person(settings).arm[0] == Approx(1.7 * 0.301));
        CHECK(one_person(settings).friction[0] == 0.2);
    }
}

TEST_CASE("By size small children stand as a dummy, adults as normal people, and nothing jumps between") {
    const auto skill_of = [](double age) {
        BodySettings settings;
        settings.age = age;
        return one_person(settings).skill[0];
    };
    CHECK((skill_of(4) == Skill::unaware && skill_of(9) == Skill::by_size && skill_of(30) == Skill::normal));
    // Returns the depth times speed that makes a person of 1 m to 1.8 m and 13 to 22 kg/m2 fall in 0.3 m of water.
    const auto limit = [](const Body& person, Skill skill) {
        constexpr double depth = 0.3;
        const Bracing bracing = bracing_of(skill, person);
        const double k = drag_upright(person.height, depth, fresh_water);
        const double weight = weight_on_feet(person, depth, fresh_water), arm = bracing.arm_share * person.height;
        const double slip = slip_demand(k, {1, 0}, Vector2d::Zero(), bracing.friction, weight);
        return depth / std::sqrt(std::max(slip, topple_demand(k, {1, 0}, depth, weight, arm)));
    };
    const auto at = [](double s) { return Body{1 + 0.8 * s, (13 + 9 * s) * std::pow(1 + 0.8 * s, 2)}; };
    for (double s = 0.01; s < 1; s += 0.01) {
        const double now = limit(at(s), Skill::by_size), before = limit(at(s - 0.01), Skill::by_size);
        CHECK(now > before);
        CHECK(now < 1.05 * before);  // the change of skill alone is a factor of 1.3 to 1.5
    }
    CHECK(limit(at(0), Skill::by_size) == limit(at(0), Skill::unaware));
    CHECK(limit(at(1), Skill::by_size) == limit(at(1), Skill::normal));
    // Cox et al. (2004): children of H m < 20 m kg are not safe at 0.4 m2/s.
    for (const Body& child : {Body{0.95, 14.3}, Body{1.02, 16.2}, Body{1.08, 18.2}})
        CHECK(limit(child, Skill::by_size) < 0.4);
}

TEST_CASE("Speeds by age are Bernardini's, and never above that on dry ground") {
    BodySettings settings;
    settings.age = 30;
    People people = one_person(settings);
    const auto speed = [&](double depth) {
        feel(people, 0, {depth, {0, 0}, 1, true});
        return speed_in_water(people, 0, 65, WalkingLaw::bernardini, {});
    };
    CHECK(speed(0) == 1.3);
    CHECK(speed(0.001) == 1.3);
    CHECK(speed(0.35) == Approx(0.35 * std::pow(0.5 * 0.35 * 0.35, -0.19)));
    people.age[0] = 78;
    CHECK(speed(0.35) == Approx(0.16 * std::pow(0.5 * 0.35 * 0.35, -0.43) / 1.16));
}
