#include <catch2/catch.hpp>

#include "fluid_server/dfsph/step_measures.hpp"

using namespace wade::fluid;

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
