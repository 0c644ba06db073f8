// Pace of progress, memory that is there.

#include <sys/resource.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <string>

#include "configs/errors/exit_code.hpp"
#include "configs/program/memory.hpp"
#include "configs/program/program.hpp"

using namespace wade;

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

TEST_CASE("memory that is not there is refused with what is needed and what is left", "[program]") {
    CHECK_NOTHROW(check_memory(2e9, 2e9, "x.json", "y"));
    CHECK_THROWS_WITH(check_memory(16.8e9, 2e9, "x.json", "lower /fluid/max_particles"),
                      "x.json: needs about 16.8 GB of memory, 2 GB are left; lower /fluid/max_particles");
    CHECK_THROWS_AS(check_memory(3e9, 2e9, "x.json", "y"), ConfigurationError);
    CHECK_THROWS_AS(check_memory(HUGE_VAL, 2e9, "x.json", "y"), ConfigurationError);
}

TEST_CASE("what is left is not more than the limit of the process", "[program]") {
    rlimit before{};
    REQUIRE(::getrlimit(RLIMIT_AS, &before) == 0);
    std::ifstream status("/proc/self/status");
    double used = 0;
    for (std::string word; used == 0 && status >> word;) {
        if (word == "VmSize:") status >> used;
    }
    REQUIRE(used > 0);
    const double free = available_memory();
    rlimit limit = before;
    limit.rlim_cur = static_cast<rlim_t>(1024 * used + 5e7);
    REQUIRE(::setrlimit(RLIMIT_AS, &limit) == 0);
    const double left = available_memory();
    REQUIRE(::setrlimit(RLIMIT_AS, &before) == 0);
    CHECK(free > 5e7);
    CHECK(left > 0);
    CHECK(left <= 5e7);
}
