#include <catch2/catch.hpp>
#include <limits>

#include "configs/errors/exit_code.hpp"
#include "fluid_server/dfsph/failure_checks.hpp"
#include "fluid_server/dfsph/time_step.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;
using Catch::Contains;

TEST_CASE("water that has run away is refused with the place of the fastest particle", "[fluid]") {
    const Fluid fluid = test::fluid_of(0.25, 10);
    Particles p(10);
    p.add({1, 2, 3}, {0, 1, 0}, Kind::fluid);
    p.add({4, 5, 6}, {0, 900, 0}, Kind::fluid);
    CHECK_NOTHROW(check_speed(p, 3.0 * runaway, 3, fluid));
    CHECK_NOTHROW(check_speed(p, 900, 0, fluid));  // a scene that speaks of no speed
    CHECK_THROWS_WITH(check_speed(p, 900, 3, fluid), Contains("at (4, 5, 6) m moves at 900 m/s") &&
                                                         Contains("100 times the 3 m/s") && Contains("/fluid/"));
}

TEST_CASE("water that is compressed by more than a tenth is refused", "[fluid]") {
    const Fluid fluid = test::fluid_of(0.25, 10);
    CHECK_NOTHROW(check_compression(0.1, fluid));
    CHECK_THROWS_WITH(check_compression(0.12, fluid), Contains("compressed by 12 % on average, more than 10 %"));
}

TEST_CASE("particles that are nowhere, or further than they can be seen, are refused", "[fluid]") {
    const Fluid fluid = test::fluid_of(0.25, 10);
    CHECK_NOTHROW(check_moves(0, 0.5, 0.5, fluid));
    CHECK_THROWS_WITH(check_moves(0, 0.6, 0.5, fluid), Contains("moves by 0.6 m in one step") && Contains("0.5 m"));
    CHECK_THROWS_WITH(check_moves(3, 0.1, 0.5, fluid), Contains("3 fluid particles") && Contains("not finite"));
    try {
        check_moves(1, 0, 1, fluid);
    } catch (const RunError& error) {
        CHECK(error.code() == ExitCode::numerical_failure);
    }
}
