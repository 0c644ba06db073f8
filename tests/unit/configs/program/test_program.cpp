#include <catch2/catch.hpp>

#include "configs/program/program.hpp"

using wade::ProgressPacer;

TEST_CASE("progress in a log is due at the first frame and every ten simulated seconds") {
    ProgressPacer plain(false);
    int lines = 0;
    for (int f = 1; f <= 900; ++f) {
        lines += plain.due(f / 30.0, 0.001 * f) ? 1 : 0;
    }
    CHECK(lines == 4);  // at the first frame, 10, 20 and 30 s
}

TEST_CASE("progress on a terminal is due five times a second of wall time") {
    ProgressPacer terminal(true);
    int lines = 0;
    for (int f = 1; f <= 1000; ++f) {
        lines += terminal.due(f / 30.0, 0.01 * f + 0.005) ? 1 : 0;
    }
    CHECK(lines == 51);  // at once, then in 10 s at each multiple of 0.2 s
}
