#include <omp.h>

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>

#include "configs/errors/exit_code.hpp"
#include "configs/numbers/fnv1a.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/obstacle.hpp"
#include "fluid_server/dfsph/fluid_world.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;

namespace {

// FNV-1a over the bits of all positions and velocities.
std::uint64_t state_hash(const Particles& p) {
    std::uint64_t hash = fnv1a_basis;
    for (const auto* array : {&p.x, &p.y, &p.z, &p.vx, &p.vy, &p.vz}) {
        for (std::size_t i = 0; i < p.count; ++i) {
            std::uint32_t bits = 0;
            std::memcpy(&bits, &(*array)[i], sizeof bits);
            hash = fnv1a_next(hash, bits);
        }
    }
    return hash;
}

std::uint64_t hash_after(const Scene& scene, int frames, int threads) {
    omp_set_num_threads(threads);
    FluidWorld world(scene);
    for (int f = 0; f < frames; ++f) {
        double remaining = 1.0 / 30;
        while (remaining > 1e-12) {
            remaining -= world.step(remaining).dt;
        }
    }
    return state_hash(world.particles());
}

}  // namespace

TEST_CASE("the same bits come out for any number of threads", "[fluid][determinism]") {
    Scene scene = test::emitter_channel(2.5, 9.81, 4000);
    scene.obstacles = {{{4, 6}, {1, 2.5}, 1}};
    const std::uint64_t one = hash_after(scene, 120, 1);
    for (const int threads : {2, 3, 5}) {
        CHECK(hash_after(scene, 120, threads) == one);
    }
    omp_set_num_threads(omp_get_num_procs());
}

TEST_CASE("sub-steps obey the time step limit and end exactly on the frame", "[fluid][time_step]") {
    const Scene scene = test::tank(1, 1, 1, 0.1);
    FluidWorld world(scene);
    const double frame = 1.0 / 30;
    const double limit = 0.4 * 0.1 / std::sqrt(9.81 * 1);  // cfl d / sqrt(g H), at rest
    double remaining = frame;
    int steps = 0;
    while (remaining > 1e-12) {
        const double dt = world.step(remaining).dt;
        CHECK(dt <= limit * (1 + 1e-12));
        remaining -= dt;
        ++steps;
    }
    CHECK(std::abs(remaining) < 1e-15);
    CHECK(steps == 3);  // 33.3 ms / 12.8 ms
}

TEST_CASE("no CFL number lets pressure or speed move a particle too far in a step", "[fluid][time_step]") {
    Scene scene = test::tank(1, 1, 1, 0.1);
    scene.fluid->cfl = 2;
    const double wave = std::sqrt(9.81 * 1);
    FluidWorld still(scene);
    CHECK(still.step(1).dt == Approx(0.5 * 0.1 / wave).epsilon(0.04));  // a whole number of steps ends with the second
    for (const double speed : {0.5 * wave, 0.8 * wave, 3 * wave}) {
        scene.channel->water_blocks[0].velocity = {0, 0, speed};
        FluidWorld world(scene);
        const double dt = world.step(1).dt;
        CHECK(dt <= 0.5 * 0.1 / wave);
        CHECK(dt <= 0.4 * 0.1 / speed * (1 + 1e-6));
        CHECK(dt > 0.9 * std::min(0.5 * 0.1 / wave, 0.4 * 0.1 / speed));
    }
}

TEST_CASE("a velocity that is not finite ends the run as a numerical failure", "[fluid][errors]") {
    Scene scene = test::tank(1, 1, 1, 0.1);
    scene.channel->water_blocks.clear();
    scene.channel->flow = Flow::recirculating;
    scene.channel->initial_river = InitialRiver::filled;
    scene.channel->velocity = std::numeric_limits<double>::infinity();
    FluidWorld world(scene);
    try {
        world.step(1.0 / 30);
        FAIL("no error");
    } catch (const RunError& error) {
        CHECK(error.code() == ExitCode::numerical_failure);
    }
}

// Beyond -1 a float is 2^-23 m/s from the next.
TEST_CASE("what is said to drive a river is what its velocities got, to the last bit", "[fluid][people]") {
    const auto driven = [](double speed) {
        Scene scene = test::tank(1, 1, 1, 0.1);
        scene.channel->water_blocks.clear();
        scene.channel->flow = Flow::recirculating;
        scene.channel->initial_river = InitialRiver::filled;
        scene.channel->velocity = speed;
        FluidWorld world(scene);
        world.set_velocity([](const std::array<double, 3>&) { return std::array<double, 3>{-1, 0, 0}; });
        const StepReport step = world.step(1.0 / 30);
        return step.driving_acceleration * step.dt;
    };
    const double bit = std::ldexp(1.0, -23);
    CHECK(driven(1 + 0.4 * bit) == 0);
    CHECK(driven(1 + 0.6 * bit) == Approx(bit).epsilon(1e-6));
    CHECK(driven(1 + 2.4 * bit) == Approx(2 * bit).epsilon(1e-6));
}

TEST_CASE("a world without particles and one with a single particle step without harm", "[fluid]") {
    Scene scene = test::tank(1, 1, 1, 0.1);
    scene.channel->water_blocks.clear();
    FluidWorld empty(scene);
    CHECK(empty.step(0.01).mean_density_error == 0);

    scene.channel->water_blocks = {{{0.4, 0.5}, {0.4, 0.5}, 0.1}};
    FluidWorld one(scene);
    REQUIRE(one.particles().count == 1);
    for (int n = 0; n < 200; ++n) {
        one.step(0.01);
    }
    CHECK(one.particles().y[0] == Approx(0.04).margin(1e-6));  // rests on the bed at the contact distance
    CHECK(one.particles().vy[0] == Approx(0).margin(1e-6));
    CHECK(one.position_clamps() == 0);
}

TEST_CASE("water that runs round and over an obstacle neither enters it nor leaves the channel", "[fluid][solids]") {
    Scene scene = test::tank(6, 3, 1, 0.2);
    scene.channel->water_blocks = {{{3.6, 6}, {0, 3}, 1.4}};
    scene.obstacles = {{{1.5, 2.5}, {0.8, 1.8}, 0.5}, {{0, 0.4}, {0, 3}, 0.3}};
    FluidWorld world(scene);
    const auto count = world.particles().count;
    for (int f = 0; f < 120; ++f) {
        double remaining = 1.0 / 30;
        while (remaining > 1e-12) {
            remaining -= world.step(remaining).dt;
        }
        const Particles& p = world.particles();
        REQUIRE(p.count == count);
        std::size_t escaped = 0;
        for (std::size_t i = 0; i < p.count; ++i) {
            const bool in_tank = p.x[i] > 0 && p.x[i] < 6 && p.y[i] > 0 && p.z[i] > 0 && p.z[i] < 3;
            bool in_obstacle = false;
            for (const Obstacle& o : scene.obstacles) {
                in_obstacle = in_obstacle ||
                              (o.x.contains(static_cast<double>(p.x[i])) && o.z.contains(static_cast<double>(p.z[i])) &&
                               static_cast<double>(p.y[i]) < o.height);
            }
            escaped += in_tank && !in_obstacle ? 0U : 1U;
        }
        REQUIRE(escaped == 0);
    }
    CHECK(world.position_clamps() == 0);
}

// 40 layers that are let go: a Jacobi iteration alone takes 738 iterations here and does not end twice.
TEST_CASE("the pressure of deep water is found in fewer iterations than Jacobi's", "[fluid][deep]") {
    Scene scene = test::tank(0.6, 0.6, 4, 0.1);
    scene.fluid->kinematic_viscosity = 0;
    FluidWorld world(scene);
    int iterations = 0, given_up = 0;
    for (int frame = 0; frame < 15; ++frame) {
        for (double left = 1.0 / 30; left > 1e-9;) {
            const StepReport report = world.step(left);
            left -= report.dt;
            iterations += report.divergence.iterations;
            given_up += report.divergence.iterations == scene.fluid->divergence_solve.max_iterations ? 1 : 0;
        }
    }
    CHECK(iterations < 600);
    CHECK(given_up == 0);
}

TEST_CASE("much calm water does not hide a part of it that is crushed", "[fluid][tolerance]") {
    // A ball of water of 0.6 m rushes together, in a tank of 4 blocks of particles and in one of 79.
    const auto largest_error = [](double length) {
        FluidWorld world(test::tank(length, 1, 1, 0.1));
        world.set_velocity([&](const std::array<double, 3>& at) {
            const std::array<double, 3> way{at[0] - 0.5 * length, at[1] - 0.5, at[2] - 0.5};
            const double rate = std::hypot(way[0], way[1], way[2]) < 0.3 ? -20 : 0;  // 1/s
            return std::array<double, 3>{rate * way[0], rate * way[1], rate * way[2]};
        });
        double most = 0;
        for (int k = 0; k < 4; ++k) most = std::max(most, world.step(0.02).max_density_error);
        return most;
    };
    // 1.5 times as large; by the mean error alone 2.5 times.
    CHECK(largest_error(20) < 2 * largest_error(1));
}
