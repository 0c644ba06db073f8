#include <sys/resource.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <string>

#include "configs/errors/exit_code.hpp"
#include "configs/program/memory.hpp"

using namespace wade;

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
