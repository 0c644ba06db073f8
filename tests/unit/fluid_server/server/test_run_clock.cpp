#include <catch2/catch.hpp>
#include <cmath>
#include <stdexcept>

#include "fluid_server/server/run_clock.hpp"

using namespace wade;
using namespace wade::fluid;

namespace {

// Wall time that passes only where a test lets it, and in the sleeps of the clock.
struct Wall {
    double now = 1000;
    int sleeps = 0;
    WallClock clock() {
        return {[this] { return now; },
                [this](double seconds) {
                    now += seconds;
                    ++sleeps;
                }};
    }
};

Scene scene_of(double rate, double duration) {
    Scene scene;
    scene.frame_rate = rate;
    scene.duration = duration;
    return scene;
}

constexpr std::uint64_t ticks_per_frame = 100'000;  // at 30 frames a second

const RunClock::Idle nothing = [] {};

}  // namespace

TEST_CASE("a tick divides a frame by a power of ten and a second by at least a million", "[server][clock]") {
    for (const double rate : {0.01, 1.0, 29.97, 30.0, 32.0, 1000.0}) {
        const Ticks ticks = ticks_of(rate);
        INFO(rate);
        CHECK(ticks.per_second >= 1'000'000);
        CHECK(static_cast<double>(ticks.per_second) / static_cast<double>(ticks.per_frame) ==
              Approx(rate).epsilon(5e-7));
    }
}

TEST_CASE("the fast pace has frames of one length, never sleeps and ends with the scene", "[server][clock]") {
    Wall wall;
    RunClock clock(scene_of(30, 2), Pace::fast, wall.clock());
    clock.start();
    std::uint64_t frames = 0;
    for (; !clock.ended(); ++frames) {
        const FrameInterval interval = clock.next_frame(nothing);
        REQUIRE(interval.begin_tick == frames * ticks_per_frame);
        REQUIRE(interval.end_tick == (frames + 1) * ticks_per_frame);
        REQUIRE(interval.duration() == 1.0 / 30);
        clock.wait_until_due(nothing);
        clock.note_sent();
        wall.now += 0.7;
    }
    CHECK(frames == 60);
    CHECK(wall.sleeps == 0);
    CHECK(clock.late_frames() == 0);
    CHECK(clock.simulated() == 2);
}

TEST_CASE("real time sends no frame before its time", "[server][clock]") {
    Wall wall;
    RunClock clock(scene_of(10, 3), Pace::real_time, wall.clock());
    clock.start();
    for (int f = 1; !clock.ended(); ++f) {
        clock.next_frame(nothing);
        wall.now += 0.01;
        clock.wait_until_due(nothing);
        REQUIRE(wall.now == Approx(1000 + 0.1 * f));
        clock.note_sent();
    }
    CHECK(clock.late_frames() == 0);
}

TEST_CASE("real time counts the frames that came late and catches up", "[server][clock]") {
    Wall wall;
    RunClock clock(scene_of(10, 1), Pace::real_time, wall.clock());
    clock.start();
    for (int f = 1; f <= 10; ++f) {
        clock.next_frame(nothing);
        wall.now += f == 3 ? 0.25 : 0.01;
        clock.wait_until_due(nothing);
        clock.note_sent();
    }
    // Frame 3 is ready at 0.45 s where 0.3 s was due, frame 4 at 0.46 s where 0.4 s was.
    CHECK(clock.late_frames() == 2);
    CHECK(clock.worst_lateness() == Approx(0.15));
    CHECK(wall.now == Approx(1001));
}

TEST_CASE("frames of variable length follow the wall clock", "[server][clock]") {
    Wall wall;
    RunClock clock(scene_of(30, 100), Pace::variable, wall.clock());
    clock.start();
    const double first = clock.next_frame(nothing).duration();
    CHECK(first == 1.0 / 30);
    const double start = wall.now;
    for (int f = 0; f < 1000; ++f) {
        const double worked = 0.0051234567 + 0.0000698765 * (f % 900);
        wall.now += worked;
        const FrameInterval interval = clock.next_frame(nothing);
        REQUIRE(interval.duration() == Approx(worked).margin(1e-6));
    }
    CHECK(std::abs(clock.simulated() - first - (wall.now - start)) < 1e-6);  // no sum of rounding
    CHECK(wall.sleeps == 0);
}

TEST_CASE("a frame of variable length lasts from a thousandth of a second to four regular frames", "[server][clock]") {
    Wall wall;
    RunClock clock(scene_of(20, 100), Pace::variable, wall.clock());
    clock.start();
    clock.next_frame(nothing);
    wall.now += 7;
    CHECK(clock.next_frame(nothing).duration() == Approx(0.2));
    wall.now += 0.05;
    CHECK(clock.next_frame(nothing).duration() == Approx(0.05).margin(1e-6));  // what was lost is not made up for
    const double before = wall.now;
    CHECK(clock.next_frame(nothing).duration() == Approx(0.001).margin(1e-6));
    CHECK(wall.now - before == Approx(0.001).margin(1e-6));  // a faster machine waits
}

TEST_CASE("frames of variable length end exactly with the scene", "[server][clock]") {
    Wall wall;
    RunClock clock(scene_of(30, 2), Pace::variable, wall.clock());
    clock.start();
    std::uint64_t last = 0;
    while (!clock.ended()) {
        const FrameInterval interval = clock.next_frame(nothing);
        REQUIRE(interval.begin_tick == last);
        REQUIRE(interval.end_tick > interval.begin_tick);
        last = interval.end_tick;
        wall.now += 0.0777;
    }
    CHECK(last == 60 * ticks_per_frame);
}

TEST_CASE("a pause stops the pace as well", "[server][clock]") {
    Wall wall;
    RunClock real_time(scene_of(10, 1), Pace::real_time, wall.clock());
    RunClock variable(scene_of(10, 1), Pace::variable, wall.clock());
    real_time.start();
    variable.start();
    variable.next_frame(nothing);
    const auto both = [&](auto&& call) {
        call(real_time);
        call(variable);
    };
    both([](RunClock& clock) { clock.pause(); });
    wall.now += 30;
    both([](RunClock& clock) { clock.pause(); });  // still the same pause
    wall.now += 30;
    both([](RunClock& clock) { clock.resume(); });
    both([](RunClock& clock) { clock.resume(); });
    wall.now += 0.05;
    CHECK(variable.next_frame(nothing).duration() == Approx(0.05).margin(1e-6));
    real_time.next_frame(nothing);
    real_time.wait_until_due(nothing);
    real_time.note_sent();
    CHECK(wall.now == Approx(1060.1));
    CHECK(real_time.late_frames() == 0);
}

TEST_CASE("a wait for the wall clock gives signs of life and can be ended", "[server][clock]") {
    Wall wall;
    RunClock clock(scene_of(0.1, 100), Pace::real_time, wall.clock());
    clock.start();
    clock.next_frame(nothing);
    int calls = 0;
    const auto idle = [&] {
        if (++calls == 100) throw std::runtime_error("enough");
    };
    CHECK_THROWS(clock.wait_until_due(idle));
    CHECK(wall.now < 1000 + 100 * 0.051);
}
