#include <algorithm>
#include <catch2/catch.hpp>

#include "configs/program/time_left.hpp"

using namespace wade;

namespace {

// A run of 100 s at 30 frames a second. Its particle number grows to `most` within `filled` s; each costs 1 us a frame.
// Holds the smallest and largest ratio of estimated to true time left, from 2 % to 90 % of the simulated time.
struct Worst {
    double least = 1e9, most = 0;
};
Worst worst_estimate(double most, double filled) {
    constexpr int frames = 3000;
    constexpr double rate = 30, end = frames / rate;
    const auto particles = [&](double t) { return filled > 0 ? most * std::min(1.0, t / filled) : most; };
    double all = 0;
    for (int f = 1; f <= frames; ++f) all += 1e-6 * particles(f / rate);
    TimeLeft left(end, most);
    Worst worst;
    double wall = 0;
    for (int f = 1; f <= frames; ++f) {
        wall += 1e-6 * particles(f / rate);
        left.note(f / rate, wall, particles(f / rate));
        if (f < 0.02 * frames || f > 0.9 * frames) continue;
        REQUIRE(left.seconds());
        worst.least = std::min(worst.least, *left.seconds() / (all - wall));
        worst.most = std::max(worst.most, *left.seconds() / (all - wall));
    }
    return worst;
}

}  // namespace

TEST_CASE("the time that is left is known from the first seconds on, whether water fills its channel or has filled it",
          "[program]") {
    const double filled = GENERATE(0.0, 10.0, 60.0, 200.0);
    CAPTURE(filled);
    // Water that has not filled the channel at the end still grows as the estimate says; marks are 2 % apart.
    const Worst worst = worst_estimate(20000, filled);
    CHECK(worst.least > 0.9);
    CHECK(worst.most < 1.1);
}

TEST_CASE("nothing is said of the time that is left before a second frame, nor of water that does not advance",
          "[program]") {
    TimeLeft left(10, 100);
    CHECK_FALSE(left.seconds());
    left.note(0.1, 1, 10);
    CHECK_FALSE(left.seconds());
    left.note(0.1, 2, 10);
    CHECK_FALSE(left.seconds());
    left.note(0.2, 3, 10);
    CHECK(left.seconds());
    CHECK(left.pace() > 0);
}

TEST_CASE("the pace is that of the last fifth of the wall time", "[program]") {
    TimeLeft left(1000, 1);
    double simulated = 0;
    for (int wall = 1; wall <= 100; ++wall) {  // fast for a while, then, as particles come, slower
        simulated += wall <= 50 ? 10 : 1;
        left.note(simulated, wall, 1);
        if (wall > 1 && wall <= 50) CHECK(left.pace() == Approx(10));
    }
    CHECK(left.pace() == Approx(1));
}

TEST_CASE("durations are rounded up in the unit that a reader can use", "[program]") {
    CHECK(duration_text(8.2) == "9 s");
    CHECK(duration_text(331) == "6 min");
    CHECK(duration_text(7300) == "3 h");
}
