// The client's loop where frames of the water and steps of the crowd differ in length.

#include <catch2/catch.hpp>
#include <utility>
#include <vector>

#include "configs/scene/crowd.hpp"
#include "crowd_client/session/run_crowds.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::MadeUpSource;
using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::one_agent_scene;

namespace {

// The number of its frame as its velocity.
MadeUpWater numbered_water(std::uint64_t frame) {
    return testing::uniform_water(0, 1, 0, 1, 0.5, 0.5, static_cast<double>(frame), 0);
}

Scene scene_with(double step_rate, double duration) {
    Scene scene = one_agent_scene(10, 25, 75, 50, 0.2);
    scene.crowd->step_rate = step_rate;
    scene.duration = duration;
    return scene;
}

using StepsAndFrames = std::vector<std::pair<std::uint64_t, std::uint64_t>>;

// Each step with the frame that it went through.
StepsAndFrames steps_of_run(CrowdRun& one, MadeUpSource& source) {
    StepsAndFrames steps;
    const CrowdWorld& crowd = one.crowd;
    RunHooks hooks;
    hooks.on_step = [&](std::size_t, const WaterView& water) {
        steps.emplace_back(crowd.steps, static_cast<std::uint64_t>(water.vx[0]));
    };
    run_crowds({&one, 1}, source, hooks);
    return steps;
}

}  // namespace

TEST_CASE("A faster crowd walks several steps through one frame") {
    CrowdRun one{.crowd = make_crowd(scene_with(45, 4 / 30.0))};
    MadeUpSource source(1000, numbered_water);
    CHECK(steps_of_run(one, source) == StepsAndFrames{{1, 1}, {2, 2}, {3, 2}, {4, 3}, {5, 4}, {6, 4}});
    CHECK(one.summary.status == "completed");
}

TEST_CASE("A slower crowd takes every frame and walks only with those at which a step is due") {
    CrowdRun one{.crowd = make_crowd(scene_with(10, 0.2))};
    MadeUpSource source(1000, numbered_water);
    CHECK(steps_of_run(one, source) == StepsAndFrames{{1, 3}, {2, 6}});
    CHECK(source.released == 6);
    CHECK(one.summary.frames == 6);
    CHECK(one.summary.frame_hash == 1006);
}

TEST_CASE("A step is as long as its rate says") {
    CrowdRun one{.crowd = make_crowd(scene_with(45, 1))};
    CHECK(one.crowd.dt == 1.0 / 45);
    MadeUpSource source(1000, numbered_water);
    steps_of_run(one, source);
    CHECK(one.crowd.steps == 45);
    CHECK(one.crowd.agents.path_length[0] == Approx(1.3).epsilon(0.05));
}

TEST_CASE("A first frame at tick 0 leads to no step") {
    CrowdRun one{.crowd = make_crowd(scene_with(30, 0.1))};
    MadeUpSource source(1000, numbered_water);
    source.tick_of = [](std::uint64_t frame) { return frame - 1; };
    CHECK(steps_of_run(one, source) == StepsAndFrames{{1, 2}, {2, 3}, {3, 4}});
    CHECK(one.summary.frames == 4);
}

TEST_CASE("Frames of changing length are followed by their ticks") {
    CrowdRun one{.crowd = make_crowd(scene_with(30, 0.2))};
    MadeUpSource source(4, numbered_water);
    source.stream.ticks_per_second = 3000;  // 100 ticks a step
    source.stream.ticks_per_frame = 100;
    source.tick_of = [](std::uint64_t frame) { return std::vector<std::uint64_t>{50, 120, 499, 600}[frame - 1]; };
    CHECK(steps_of_run(one, source) == StepsAndFrames{{1, 2}, {2, 3}, {3, 3}, {4, 3}, {5, 4}, {6, 4}});
    CHECK(one.summary.status == "completed");
}

TEST_CASE("Frames that were dropped leave their steps to the newest frame") {
    CrowdRun one{.crowd = make_crowd(scene_with(30, 0.2))};
    MadeUpSource source(1000, numbered_water);
    source.stride = 3;
    source.number_of_next = 2;
    CHECK(steps_of_run(one, source) == StepsAndFrames{{1, 2}, {2, 2}, {3, 5}, {4, 5}, {5, 5}, {6, 8}});
    CHECK(one.summary.status == "completed");
    CHECK(one.summary.frames == 3);
    CHECK(one.summary.dropped_frames == 6);
    CHECK(one.summary.frame_hash == 0);
}

TEST_CASE("A run whose last step is due after the last frame is completed all the same") {
    CrowdRun one{.crowd = make_crowd(scene_with(32.5, 1))};  // 32.5 steps, counted as 33
    MadeUpSource source(30, numbered_water);
    CHECK(steps_of_run(one, source).size() == 32);
    CHECK(one.summary.status == "completed");
}

TEST_CASE("Nobody walks on in the middle of a frame once the run is over") {
    Scene scene = one_agent_scene(74, 46, 75, 50, 0);
    scene.duration = 100;
    scene.crowd->step_rate = 300;
    CrowdRun one{.crowd = make_crowd(scene)};
    MadeUpSource source(100'000, numbered_water);
    steps_of_run(one, source);
    CHECK(one.crowd.arrived == 1);
    CHECK(one.crowd.steps == one.crowd.last_arrival_step);
    CHECK(one.crowd.steps % 10 != 0);
}

TEST_CASE("Events of a frame hold from its first step on") {
    Scene scene = scene_with(60, 0.2);
    scene.events.push_back({3, std::nullopt, std::nullopt, 0.9});
    CrowdWorld crowd = make_crowd(scene);
    std::vector<double> tau;
    for (int i = 0; i < 6; ++i) {
        step(crowd, {});
        tau.push_back(crowd.agents.tau[0]);
    }
    CHECK(tau == std::vector<double>{0.2, 0.2, 0.2, 0.2, 0.9, 0.9});
}
