// How people hold themselves: nothing jumps, whatever becomes of them, and what their bodies do is what sources say.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <set>

#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "crowd_client/crowd_world.hpp"
#include "made_up_water.hpp"

namespace wade::crowd::pose_test {

using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::one_agent_scene;
using wade::crowd::testing::uniform_water;

constexpr double pi = std::numbers::pi, e = std::numbers::e;

// What |x'| is at most, if all aims lie within `apart` of one another.
double fastest(double pace, double apart) {
    return pace * apart / e;
}

// A man of 1.70 m and 65 kg walks across an even river; his speed on dry ground is 1.3 m/s.
Scene crossing(double rate, Skill skill) {
    Scene scene = one_agent_scene(50, 16, 50, 36, 0);
    scene.fluid->particle_spacing = 0.25;
    scene.crowd->response = ResponseKind::measured;
    scene.crowd->step_rate = scene.frame_rate = rate;
    scene.crowd->pose_rate = rate;
    AgentGroup& group = scene.crowd->groups[0];
    group.tau.reset();
    group.body.sex = SexRule::male;
    group.body.skill = skill;
    return scene;
}

// Water on a lattice that has the depth exactly.
MadeUpWater stream(double depth, double speed) {
    MadeUpWater water = uniform_water(30, 60, 12, 38, 0.25, 0.25, -speed, 0);
    for (float& mass : water.mass) mass *= static_cast<float>(depth / 0.25);
    return water;
}

// The largest changes in a second from one pose to the next.
struct Changes {
    double heading = 0, lean = 0, hip = 0, step_length = 0, phase = 0, turning = 0, speed = 0;

    void add(const Pose& a, const Pose& b, double dt) {
        const auto take = [dt](double& most, double change) { most = std::max(most, std::abs(change) / dt); };
        take(heading, b.heading.value - a.heading.value);
        take(lean, (b.lean.value - a.lean.value).norm());
        take(hip, b.hip.value - a.hip.value);
        take(step_length, b.step_length.value - a.step_length.value);
        take(phase, std::remainder(b.gait_phase - a.gait_phase, 1));
        take(turning, (b.turning.value - a.turning.value).cwiseAbs().maxCoeff());
        take(speed, (b.velocity.value - a.velocity.value).norm());
    }
    // Limits of the law for values that follow an aim. Leans differ by at most pi and turn with the water. Hips lie
    // between the ground and 1 m of water or a leg, steps between 0 and that of 182 a minute, speeds within +-3 m/s.
    void check() const {
        CHECK(heading <= fastest_turn + fastest_tumbling);
        CHECK(lean <= fastest(body_pace, pi) + fastest_tumbling * pi / 2);
        CHECK(hip <= fastest(body_pace, 1));
        CHECK(step_length <= fastest(body_pace, 0.24 * 1.7 * 182 / 60));
        CHECK(phase <= 0.5 * 182 / 60);
        CHECK(turning <= fastest(body_pace, 2 * fastest_tumbling));
        CHECK(speed <= fastest(speed_pace, 6));
    }
};

TEST_CASE("A value that follows its aim does so alike at any rate, and never faster than the law allows") {
    const auto followed = [](double rate) {
        Smoothed<double> x{0, 0};
        for (int i = 0; i < static_cast<int>(rate); ++i) follow(x, i < rate / 2 ? 1.0 : -0.5, 5, 1 / rate);
        return x;
    };
    for (const double rate : {10.0, 60.0}) {
        CHECK(followed(rate).value == Approx(followed(30).value).epsilon(1e-12));
        CHECK(followed(rate).rate == Approx(followed(30).rate).epsilon(1e-12));
    }
    // An aim that changes sides whenever that hurries the value most: 1/w before and after.
    Smoothed<double> x{-1, 0};
    double most = 0;
    for (int i = 0; i < 10000; ++i) {
        const double before = x.value;
        follow(x, i % 80 < 40 ? 1.0 : -1.0, 5, 0.005);
        most = std::max(most, std::abs(x.value - before) / 0.005);
    }
    CHECK(most <= fastest(5, 2));
    CHECK(most >= 0.3 * fastest(5, 2));
}

TEST_CASE("A condition that comes and goes with single steps lasts") {
    for (const double rate : {10.0, 30.0, 60.0}) {
        LastingCondition lasting;
        int changes = 0;
        const auto pass = [&](double time, int of, int in) {  // holds in so many of so many steps
            for (int i = 0; i < time * rate; ++i) {
                const bool before = lasting.holds;
                note(lasting, i % in < of, 1 / rate);
                changes += before != lasting.holds ? 1 : 0;
            }
        };
        pass(5, 1, 10);
        CHECK_FALSE(lasting.holds);
        pass(5, 9, 10);
        CHECK(lasting.holds);
        pass(5, 2, 3);
        CHECK(lasting.holds);
        CHECK(changes == 1);
        pass(1, 0, 1);
        CHECK_FALSE(lasting.holds);
        CHECK(changes == 2);
    }
}

TEST_CASE("Steps are those of Inman: 0.74 m, 109 a minute at 1.34 m/s, and in water shorter and fewer with the speed") {
    CHECK(step_length_at(1.34, 1.7) == Approx(0.739).margin(0.0005));
    CHECK(60 * cadence_of(step_length_at(1.34, 1.7), 1.7) == Approx(108.7).margin(0.05));
    for (const double speed : {0.2, 0.67, 1.34, 2.0}) {
        const double length = step_length_at(speed, 1.7);
        CHECK(length * cadence_of(length, 1.7) == Approx(speed));
    }
    CHECK(60 * cadence_of(step_length_at(20, 1.7), 1.7) == Approx(182));  // the fastest cadence

    // Half a metre of still water: 0.54 of the speed, so 0.73 of length and cadence.
    const auto strides = [](double depth) {
        CrowdWorld crowd = make_crowd(crossing(30, Skill::normal));
        const MadeUpWater water = stream(std::max(depth, 0.25), 0);
        double count = 0, from = 0;
        for (int i = 0; i < 30 * 8; ++i) {
            const double before = crowd.poses[0].gait_phase;
            step(crowd, depth > 0 ? water.view() : WaterView{});
            if (i < 60) {  // until it walks evenly
                from = crowd.agents.path_length[0];
                continue;
            }
            const double made = crowd.poses[0].gait_phase - before;
            count += made < 0 ? made + 1 : made;
        }
        const double length = crowd.poses[0].step_length.value;
        // The lengths of all strides sum to the path, within a twentieth: speeds change a little from step to step.
        CHECK(2 * count * length == Approx(crowd.agents.path_length[0] - from).epsilon(0.05));
        return std::array{length, count};
    };
    const auto dry = strides(0), wet = strides(0.5);
    const double slower = std::sqrt(walking_speed_ratio(Sex::male, 0.5, 0, 9.81));
    CHECK(wet[0] / dry[0] == Approx(slower).epsilon(0.05));
    CHECK(wet[1] / dry[1] == Approx(slower).epsilon(0.05));
}

TEST_CASE("Who braces leans against the stream as far as the drag asks, and not without a stream") {
    People people;
    AgentGroup group;
    group.body.skill = Skill::braced;
    add_person(people, group, {}, true, {0.9, 0.5, 0.5, 0.5, 0.5});
    const auto lean_in = [&](double speed) {
        Pose pose = standing_pose(people, 0, {0, 1});
        PoseStep step{1.0 / 30, 1, {-speed, 0}, 0, {0, 0}, {0, 0}, 65, {}};
        for (int i = 0; i < 300; ++i) advance_pose(pose, people, 0, Posture::upright, step);
        return pose.lean.value;
    };
    CHECK(lean_in(0).norm() == 0);
    CHECK(lean_in(0.5).norm() == 0);  // the feet alone hold it
    const Vector2d at_most = lean_in(2.5);
    CHECK(at_most.x() == Approx(std::asin((0.20 - 0.04) / 0.55)));  // 17 degrees, upstream
    CHECK(at_most.y() == Approx(0).margin(1e-12));
    CHECK(lean_in(1.2).x() > 0);
    CHECK(lean_in(1.2).x() < at_most.x());
}

TEST_CASE(
    "Who topples falls downstream in about a second, lies, drifts, gets up by its postures and walks on: nothing "
    "jumps") {
    for (const double rate : {10.0, 30.0, 60.0}) {
        CAPTURE(rate);
        CrowdWorld crowd = make_crowd(crossing(rate, Skill::normal));
        const MadeUpWater fast = stream(1, 2.5), shallow = stream(0.25, 1.3), slow = stream(0.25, 0.2);
        Changes changes;
        std::set<Posture> seen;
        double fell = 0, lay = 0, last_lean = 0;
        for (int i = 1; i <= 16 * rate; ++i) {
            const Pose before = crowd.poses[0];
            const double time = i / rate;
            step(crowd, time >= 2 && time < 5 ? fast.view() : time >= 5 && time < 7 ? shallow.view() : slow.view());
            const Pose& pose = crowd.poses[0];
            changes.add(before, pose, 1 / rate);
            seen.insert(pose.posture);
            const double lean = -pose.lean.value.x();  // downstream
            if (fell == 0 && pose.posture == Posture::falling) fell = time;
            if (fell > 0 && lay == 0) CHECK(lean >= last_lean - 1e-3);  // the lean never decreases
            if (fell > 0 && lay == 0 && lean > 0.9 * pi / 2) lay = time;
            if (time > 4.5 && time < 5) {
                CHECK(pose.lean.value.x() == Approx(-pi / 2).epsilon(0.01));
                CHECK(pose.hip.value == Approx(1 - 0.125).epsilon(0.03));  // just below the surface
                CHECK(pose.step_length.value < 0.01);
                CHECK(pose.turning.value.z() == Approx(0.5 * 2.5 / 1).epsilon(0.05));
            }
            last_lean = lean;
        }
        changes.check();
        CHECK(lay - fell == Approx(3.9 / body_pace).margin(0.2));
        for (const Posture posture : {Posture::upright, Posture::falling, Posture::lying, Posture::kneeling,
                                      Posture::squatting, Posture::rising}) {
            CHECK(seen.contains(posture));
        }
        const Pose& pose = crowd.poses[0];
        CHECK(pose.posture == Posture::upright);
        CHECK(pose.hip.value == Approx(0.53 * 1.7).epsilon(0.01));
        CHECK(pose.step_length.value > 0.3);
        CHECK(pose.heading.value == Approx(pi / 2).margin(0.6));  // towards its goal again, now a little upstream
    }
}

TEST_CASE("Who floats goes with the surface; who swims lies in the water") {
    for (const bool can_swim : {false, true}) {
        Scene scene = crossing(30, Skill::normal);
        scene.crowd->groups[0].body.can_swim = can_swim;
        CrowdWorld crowd = make_crowd(scene);
        const MadeUpWater deep = stream(1.6, 0.1);
        std::set<Posture> seen;
        Changes changes;
        for (int i = 1; i <= 90; ++i) {
            const Pose before = crowd.poses[0];
            step(crowd, deep.view());
            changes.add(before, crowd.poses[0], 1.0 / 30);
            seen.insert(crowd.poses[0].posture);
        }
        CHECK(seen.contains(can_swim ? Posture::swimming : Posture::floating));
        CHECK(crowd.poses[0].hip.value == Approx(1.6 - (can_swim ? 0.15 : 0.125)).epsilon(0.02));
        CHECK(changes.hip <= fastest(body_pace, 1.6));
    }
}

TEST_CASE(
    "With the response of the paper who has a large tau lies in a fast stream, without jumps, and rises when it has "
    "gone") {
    for (const double rate : {10.0, 30.0, 60.0}) {
        Scene scene = crossing(rate, Skill::normal);
        scene.crowd->response = ResponseKind::paper;
        scene.crowd->groups[0].tau = 0.9;
        CrowdWorld crowd = make_crowd(scene);
        const MadeUpWater fast = stream(1, 2.5);
        Changes changes;
        const auto pass = [&](double time, const WaterView& water) {
            for (int i = 0; i < time * rate; ++i) {
                const Pose before = crowd.poses[0];
                step(crowd, water);
                changes.add(before, crowd.poses[0], 1 / rate);
            }
        };
        pass(1, {});
        CHECK(crowd.poses[0].posture == Posture::upright);
        pass(3, fast.view());
        CHECK(crowd.poses[0].posture == Posture::lying);
        pass(3, {});
        CHECK(crowd.poses[0].posture == Posture::upright);
        CHECK(crowd.poses[0].lean.value.norm() < 0.01);
        changes.check();
    }
}

TEST_CASE("Who stands does not turn, however the water flickers, and a turn round takes a second or more") {
    Scene scene = crossing(30, Skill::braced);
    scene.crowd->groups[0].desired_speed = 0;
    CrowdWorld crowd = make_crowd(scene);
    for (int i = 0; i < 150; ++i) step(crowd, stream(0.5, i % 2 == 0 ? 0.5 : -0.5).view());
    CHECK(crowd.poses[0].heading.value == Approx(pi / 2).margin(1e-12));

    People people;
    add_person(people, AgentGroup{}, {}, true, {0.9, 0.5, 0.5, 0.5, 0.5});
    Pose pose = standing_pose(people, 0, {1, 0});
    PoseStep back{1.0 / 30, 0, {0, 0}, 0, {-1, 0}, {-1.3, 0.01}, 65, {}};
    double time = 0;
    for (; time < 5 && std::abs(pose.heading.value) < 0.9 * pi; time += back.dt) {
        advance_pose(pose, people, 0, Posture::upright, back);
    }
    CHECK(time > 0.9);
    CHECK(time < 2);
}

TEST_CASE("Poses change no path") {
    for (const ResponseKind response : {ResponseKind::paper, ResponseKind::measured}) {
        Scene scene = crossing(30, Skill::normal);
        scene.crowd->response = response;
        if (response == ResponseKind::paper) scene.crowd->groups[0].tau = 0.5;
        CrowdWorld with = make_crowd(scene);
        scene.crowd->pose_rate = 0;
        CrowdWorld without = make_crowd(scene);
        const MadeUpWater water = stream(1, 1.2);
        for (int i = 0; i < 60; ++i) {
            step(with, water.view());
            step(without, water.view());
        }
        CHECK(with.agents.position[0] == without.agents.position[0]);
        CHECK(without.poses.empty());
        CHECK(without.felt.empty() == (response == ResponseKind::paper));
    }
}

}  // namespace wade::crowd::pose_test
