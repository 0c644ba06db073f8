#include <catch2/catch.hpp>

#include "fluid_server/estimate.hpp"
#include "fluid_server/make_model.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;

TEST_CASE("an estimate is told in units that a reader can use", "[estimate]") {
    CHECK(text_of({27619, 40.2e6, 178}) == "at most 27619 particles, 41 MB of memory, about 3.0 min of CPU time");
    CHECK(text_of({1, 9.4e6, 0.3}) == "at most 1 particles, 10 MB of memory, less than 1 s of CPU time");
    CHECK(text_of({100000000, 30.6e9, 4e6}) ==
          "at most 100000000 particles, 31 GB of memory, about 46 days of CPU time");
}

TEST_CASE("an estimate grows with the room for particles and the run, not with dry ground", "[estimate]") {
    const auto of = [](auto&& change) {
        Scene scene = test::tank(4, 2, 1, 0.25);
        scene.fluid.max_particles = 512;
        change(scene);
        return estimate(scene);
    };
    const Estimate as_is = of([](Scene&) {});
    CHECK(as_is.particles == 512);
    CHECK(of([](Scene& s) { s.fluid.max_particles = 100000000; }).memory > 2e10);
    // Dry ground takes no memory: a channel of 1e5 m x 1e5 m has 3e11 cells, 4 bytes each if they were kept.
    CHECK(of([](Scene& s) { s.channel.x.hi = s.channel.z.hi = 1e5; }).memory == Approx(as_is.memory).epsilon(0.01));
    CHECK(of([](Scene& s) { s.duration *= 10; }).cpu_time == Approx(10 * as_is.cpu_time));
    CHECK(of([](Scene& s) {
              s.fluid.model = ModelKind::shallow_water;
              s.fluid.shallow_water.cell_size = 1e-3;
          }).memory > 1e9);
}
