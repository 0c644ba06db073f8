#include <omp.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "fluid_server/dfsph/bed_friction.hpp"
#include "fluid_server/dfsph/fluid_world.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;

namespace {

// A wide uniform stream, 6 m of it, periodic along and across.
Scene stream(double depth, double velocity, double slope, double manning_n) {
    Scene scene;
    scene.channel->x = {0, 6};
    scene.channel->z = {0, 2};
    scene.channel->flow = Flow::periodic;
    scene.channel->sides = Sides::periodic;
    scene.channel->initial_river = InitialRiver::filled;
    scene.channel->depth = depth;
    scene.channel->velocity = velocity;
    scene.channel->slope = slope;
    scene.channel->manning_n = manning_n;
    scene.fluid = test::fluid_of(0.25, 2000);
    return scene;
}

void run(FluidWorld& world, double duration) {
    double remaining = duration;
    while (remaining > 1e-9 * duration) {
        remaining -= world.step(std::min(remaining, 0.1)).dt;
    }
}

double mean_speed(const Particles& p) {
    double sum = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        sum -= static_cast<double>(p.vx[i]);
    }
    return sum / static_cast<double>(p.count);
}

}  // namespace

TEST_CASE("a uniform stream on a slope reaches Manning's speed", "[fluid][friction]") {
    struct Case {
        double depth, slope, n, start;
    };
    // From rest and from above; the time scale of the approach is V / (2 g S).
    for (const Case& c : {Case{1, 0.01, 0.1, 0}, Case{0.5, 0.02, 0.08, 3}}) {
        FluidWorld world(stream(c.depth, c.start, c.slope, c.n));
        const double truth = std::pow(c.depth, 2.0 / 3) * std::sqrt(c.slope) / c.n;
        run(world, 5 * truth / (2 * 9.81 * c.slope));
        CHECK(mean_speed(world.particles()) == Approx(truth).epsilon(0.02));
        CHECK(world.position_clamps() == 0);
    }
}

TEST_CASE("without slope a stream decays as Manning's formula says", "[fluid][friction]") {
    // dU/dt = -c U^2 with c = g n^2 / h^(4/3) gives U = U_0 / (1 + c U_0 t).
    FluidWorld world(stream(1, 2, 0, 0.1));
    const double c = 9.81 * 0.1 * 0.1;
    for (int s = 1; s <= 5; ++s) {
        run(world, 1);
        CHECK(mean_speed(world.particles()) == Approx(2 / (1 + c * 2 * s)).epsilon(0.01));
    }
}

TEST_CASE("friction leaves still water still, whatever n is", "[fluid][friction]") {
    FluidWorld world(stream(1, 0, 0, 1));
    run(world, 1);  // later the lattice of this water, which has no viscosity, falls into disorder and moves by itself
    const Particles& p = world.particles();
    double fastest = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        fastest = std::max(fastest, std::hypot(static_cast<double>(p.vx[i]), static_cast<double>(p.vz[i])));
    }
    CHECK(fastest < 0.01 * std::sqrt(9.81));
}

TEST_CASE("friction never turns water round, and a film has that of half a spacing", "[fluid][friction]") {
    Scene scene = stream(1, 0, 0, 1);
    BedFriction friction(scene);
    Particles p(10);
    p.add({3, 0.1F, 1}, {-5, 0, 2}, Kind::fluid);
    p.add({3.1F, 0.1F, 1}, {-7, 0, 0}, Kind::inflow);
    friction.apply(p, 0.01F);
    // One particle in a cell of 1 m x 1 m would be 1.6 cm of water.
    const double k = 9.81 * std::hypot(5.0, 2.0) / std::pow(0.125, 4.0 / 3);
    CHECK(static_cast<double>(p.vx[0]) == Approx(-5 / (1 + 0.01 * k)));
    CHECK(static_cast<double>(p.vz[0]) == Approx(2 / (1 + 0.01 * k)));
    CHECK(p.vx[1] == -7);  // still in the emitter
    for (int n = 0; n < 100; ++n) {
        friction.apply(p, 10);
        REQUIRE(p.vx[0] <= 0);
    }
}

TEST_CASE("a column stands on the ground that a tall obstacle leaves it", "[fluid][friction]") {
    Scene scene = stream(1, 0, 0, 0.1);
    scene.obstacles = {{{2, 3}, {0, 0.5}, 1}};  // half of the cell x 2 to 3 m, z 0 to 1 m
    BedFriction friction(scene);
    Particles p(200);
    for (int i = 0; i < 32; ++i) {
        p.add({2.5F, 0.5F, 0.75F}, {-1, 0, 0}, Kind::fluid);  // 0.5 m^3 on 0.5 m^2
    }
    friction.apply(p, 1);
    CHECK(static_cast<double>(p.vx[0]) == Approx(-1 / (1 + 9.81 * 0.01)));
}

TEST_CASE("friction gives the same bits for any number of threads", "[fluid][friction][determinism]") {
    const auto speed = [](int threads) {
        omp_set_num_threads(threads);
        Scene scene = stream(1, 1, 0.01, 0.05);
        scene.channel->x.hi = 40;
        scene.fluid->max_particles = 6000;
        FluidWorld world(scene);
        run(world, 0.5);
        return mean_speed(world.particles());
    };
    const double one = speed(1);
    CHECK(speed(3) == one);
    omp_set_num_threads(omp_get_num_procs());
}
