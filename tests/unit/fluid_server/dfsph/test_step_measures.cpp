#include <catch2/catch.hpp>
#include <limits>

#include "configs/errors/exit_code.hpp"
#include "fluid_server/dfsph/step_measures.hpp"
#include "fluid_server/dfsph/time_step.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;
using Catch::Contains;

TEST_CASE("the fastest and the highest of many particles are found wherever they are", "[fluid]") {
    constexpr std::size_t n = 3 * block_size + 5;
    const std::size_t at = GENERATE(std::size_t{0}, block_size, n - 1);
    Particles p(n);
    for (std::size_t i = 0; i < n; ++i) p.add({0, 1, 0}, {1, 0, 0}, Kind::fluid);
    p.vx[at] = 2, p.vy[at] = 3, p.vz[at] = 6;
    p.y[n - 1 - at] = 4;
    StepMeasures measures;
    const Motion motion = measures.motion(p);
    CHECK(motion.fastest == 7);
    CHECK(motion.highest == 4);
}

TEST_CASE("only compression is an error of density", "[fluid]") {
    StepMeasures measures;
    const DensityError error = measures.density_error({0.5F, 1, 1.25F, 1.75F, 9}, 4);
    CHECK(error.mean == 0.25);
    CHECK(error.max == 0.75);
    CHECK(measures.density_error({}, 0).mean == 0);
}

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
