// What a step notes of itself, and which settings are stabler.

#include <catch2/catch.hpp>
#include <limits>

#include "configs/errors/exit_code.hpp"
#include "configs/loading/scene_loader.hpp"
#include "configs/scene/fluid.hpp"
#include "fluid_server/dfsph/stabler_settings.hpp"
#include "fluid_server/dfsph/step_measures.hpp"
#include "fluid_server/dfsph/time_step.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;
using Catch::Contains;

namespace stabler_settings_test {

namespace {

Fluid default_fluid() {
    return load_scene_text(R"({
        "channel": { "x_min_m": 0, "x_max_m": 20, "z_min_m": 4, "z_max_m": 8, "flow": "emitter", "velocity_m_s": 1 },
        "fluid": { "particle_spacing_m": 0.5 } })",
                           "scene.json")
        .scene.fluid;
}

}  // namespace

TEST_CASE("with the schema's defaults the advice is half the time step", "[fluid][advice]") {
    Fluid fluid = default_fluid();
    CHECK(advice(fluid) == "change /fluid/cfl from 0.5 to 0.25");
    CHECK(options_of_advice(fluid) == " --set /fluid/cfl=0.25");
    fluid.cfl = 0.2;
    fluid.density_solve.tolerance = 1e-4;
    CHECK(advice(fluid) == "change /fluid/cfl from 0.2 to 0.1");
}

TEST_CASE("what is looser than the schema's defaults goes back to them", "[fluid][advice]") {
    const Fluid usual = default_fluid();
    Fluid fluid = usual;
    fluid.cfl = 2;
    fluid.density_solve.tolerance = 0.1;
    fluid.density_solve.max_iterations = 1;
    fluid.divergence_solve.tolerance = 0.05;
    fluid.divergence_solve.max_iterations = 3;
    const auto changes = stabler_settings(fluid);
    REQUIRE(changes.size() == 5);
    CHECK(std::stod(changes[0].to) == usual.cfl);
    CHECK(std::stod(changes[1].to) == usual.density_solve.tolerance);
    CHECK(std::stoi(changes[2].to) == usual.density_solve.max_iterations);
    CHECK(std::stod(changes[3].to) == usual.divergence_solve.tolerance);
    CHECK(std::stoi(changes[4].to) == usual.divergence_solve.max_iterations);

    fluid = usual;
    fluid.divergence_solve.max_iterations = 0;  // switched off on purpose
    fluid.density_solve.max_iterations = 10;
    CHECK(advice(fluid) == "change /fluid/density_solve/max_iterations from 10 to 100");
}

}  // namespace stabler_settings_test

namespace step_measures_test {

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

}  // namespace step_measures_test
