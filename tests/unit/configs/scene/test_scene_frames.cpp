// When the crowd takes its steps, in frames and ticks of the water.

#include "configs/scene/crowd.hpp"
#include "configs/scene/scene_frames.hpp"
#include "scene_texts.hpp"

using namespace wade::test;

namespace {

wade::Scene with_rates(double frames, double steps) {
    wade::Scene scene;
    scene.frame_rate = frames;
    scene.crowd->step_rate = steps;
    return scene;
}

}  // namespace

TEST_CASE("the crowd steps once a frame unless the scene says otherwise") {
    const wade::Scene scene = load_patched(R"({"frame_rate_hz": 25})").scene;
    CHECK(scene.crowd->step_rate == 25);
}

TEST_CASE("at equal rates one step is due with each frame, whatever the rate") {
    for (const double rate : {30.0, 29.97, 59.94, 7.3, 1000.0}) {
        const wade::Scene scene = with_rates(rate, rate);
        // As the server chooses them: at least a million ticks a second.
        const std::uint64_t ticks_per_frame = 100'000;
        const auto ticks_per_second = static_cast<std::uint64_t>(std::llround(rate * 100'000));
        for (std::uint64_t frame = 0; frame <= 20'000; ++frame) {
            REQUIRE(wade::steps_due(scene, frame * ticks_per_frame, ticks_per_second) == frame);
        }
    }
}

TEST_CASE("a crowd of another rate takes a step whenever its time has come") {
    CHECK(wade::steps_due(with_rates(30, 120), 1, 30) == 4);  // four steps in a frame
    CHECK(wade::steps_due(with_rates(30, 10), 2, 30) == 0);   // a step every three frames
    CHECK(wade::steps_due(with_rates(30, 10), 3, 30) == 1);
    CHECK(wade::steps_due(with_rates(30, 45), 1, 30) == 1);  // one and two in turn
    CHECK(wade::steps_due(with_rates(30, 45), 2, 30) == 3);
}

TEST_CASE("an event of a frame holds from the first step after the frame before") {
    CHECK(wade::step_of_frame(with_rates(30, 30), 0) == 0);
    CHECK(wade::step_of_frame(with_rates(30, 30), 7) == 7);
    CHECK(wade::step_of_frame(with_rates(30, 120), 2) == 5);
    CHECK(wade::step_of_frame(with_rates(30, 10), 3) == 1);
    CHECK(wade::step_of_frame(with_rates(30, 10), 4) == 2);
}

TEST_CASE("a run has as many steps as its duration holds") {
    wade::Scene scene = with_rates(30, 120);
    scene.duration = 2.5;
    CHECK(wade::frames_of(scene) == 75);
    CHECK(wade::steps_of(scene) == 300);
}
