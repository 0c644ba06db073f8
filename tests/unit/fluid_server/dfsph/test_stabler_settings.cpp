#include <catch2/catch.hpp>

#include "configs/loading/scene_loader.hpp"
#include "fluid_server/dfsph/stabler_settings.hpp"

using namespace wade;
using namespace wade::fluid;

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
