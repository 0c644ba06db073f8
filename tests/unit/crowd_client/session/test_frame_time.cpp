// Which steps of the crowd a frame of the water leads to.

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <limits>

#include "configs/scene/crowd.hpp"
#include "configs/scene/scene_frames.hpp"
#include "crowd_client/session/frame_time.hpp"

using namespace wade;
using namespace wade::crowd;

namespace {

Scene scene_of(double frame_rate, double step_rate, double duration = 400) {
    Scene scene;
    scene.duration = duration;
    scene.frame_rate = frame_rate;
    scene.crowd->step_rate = step_rate;
    return scene;
}

shm::StreamInfo stream_of(std::uint64_t ticks_per_second, std::uint64_t ticks_per_frame) {
    shm::StreamInfo info;
    info.producer_name = "other_producer";
    info.ticks_per_second = ticks_per_second;
    info.ticks_per_frame = ticks_per_frame;
    return info;
}

}  // namespace

TEST_CASE("At equal rates each frame leads to one step, also where whole ticks round the rate down or up") {
    // Two thirds, a seventh and 100/3 of a frame a second; the last two by either neighbour in ticks.
    const struct {
        double rate;
        std::uint64_t ticks_per_second, ticks_per_frame;
    } cases[] = {{30, 30, 1},
                 {2.0 / 3, 6'666'667, 10'000'000},
                 {1.0 / 7, 1'428'571, 10'000'000},
                 {100.0 / 3, 33'333'333, 1'000'000},
                 {100.0 / 3, 33'333'334, 1'000'000}};
    for (const auto& c : cases) {
        const Scene scene = scene_of(c.rate, c.rate, 20'000 / c.rate);
        const shm::StreamInfo info = stream_of(c.ticks_per_second, c.ticks_per_frame);
        for (std::uint64_t frame = 0; frame <= 20'000; ++frame) {
            REQUIRE(steps_due_at(scene, info, frame * c.ticks_per_frame) == frame);
        }
    }
}

TEST_CASE("The first step after a frame is that of the next frame's events") {
    for (const auto& [frames, steps] : {std::pair{30.0, 45.0}, {30.0, 10.0}, {29.97, 100.0}, {7.0, 3.0}}) {
        const Scene scene = scene_of(frames, steps);
        const auto ticks_per_second = static_cast<std::uint64_t>(std::llround(frames * 1e6));
        for (std::uint64_t frame = 0; frame < 1000; ++frame) {
            REQUIRE(steps_due_at(scene, stream_of(ticks_per_second, 1'000'000), frame * 1'000'000) + 1 ==
                    step_of_frame(scene, frame + 1));
        }
    }
}

TEST_CASE("Frames of any length lead to the steps whose time has come") {
    const Scene scene = scene_of(30, 30);
    const shm::StreamInfo info = stream_of(1000, 100);
    CHECK(steps_due_at(scene, info, 0) == 0);
    CHECK(steps_due_at(scene, info, 33) == 0);
    CHECK(steps_due_at(scene, info, 34) == 1);
    CHECK(steps_due_at(scene, info, 100) == 3);
    CHECK(steps_due_at(scene, info, 999) == 29);
    CHECK(steps_due_at(scene, info, 1000) == 30);
}

TEST_CASE("No tick leads beyond the last step") {
    const Scene scene = scene_of(30, 45, 2);
    for (const std::uint64_t tick : {std::uint64_t{61}, std::numeric_limits<std::uint64_t>::max()}) {
        CHECK(steps_due_at(scene, stream_of(30, 1), tick) == 90);
        CHECK(steps_due_at(scene, stream_of(30, 7), tick) == 90);
    }
}

TEST_CASE("A stream as fast as the scene needs no note, another one is named with both rates") {
    CHECK(rate_note(scene_of(29.97, 30), stream_of(2'997'000, 100'000)).empty());
    const std::string note = rate_note(scene_of(30, 30), stream_of(1000, 40));
    CHECK_THAT(note,
               Catch::Contains("'other_producer' sends 25 frames a second") && Catch::Contains("/frame_rate_hz 30"));
    CHECK_THAT(rate_note(scene_of(30, 30), stream_of(1000, 0)), Catch::Contains("does not say"));
}
