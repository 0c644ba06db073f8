#include <omp.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "flock_pair.hpp"

using namespace wade;
using namespace wade::fluid;
using namespace wade::fluid::test;
using steering::SteeringWorld;

namespace {

void advance(SteeringWorld& world, double time) {
    for (int k = 0; k < static_cast<int>(time * 30 + 0.5); ++k) {
        for (double left = 1.0 / 30; left > 1e-9;) left -= world.step(left).dt;
    }
}

Scene steering_river(Flow flow) {
    Scene scene = steering_tank(6, 3, 0.9, 0.3);
    scene.channel->flow = flow;
    scene.channel->water_blocks.clear();
    scene.channel->depth = 0.9;
    scene.channel->velocity = 1.5;
    if (flow == Flow::recirculating) scene.channel->initial_river = InitialRiver::filled;
    scene.fluid->max_particles = 1200;
    return scene;
}

}  // namespace

TEST_CASE("a container comes to rest: the kinetic energy falls by 1e4 within 20 s, the energy never grows",
          "[steering]") {
    const Scene scene = steering_tank(0.8, 0.8, 0.8, 0.1);
    SteeringWorld world(scene);
    advance(world, 1.0 / 30);  // the energy of the pairs is of the lists
    const double first = world.energies().total();
    double largest = 0, last = 0, highest_total = first;
    for (int k = 0; k < 200; ++k) {
        advance(world, 0.1);
        const steering::Energies e = world.energies();
        largest = std::max(largest, e.kinetic);
        last = e.kinetic;
        highest_total = std::max(highest_total, e.total());
    }
    CHECK(last < 1e-4 * largest);
    CHECK(highest_total <= first * (1 + 1e-4));
}

TEST_CASE("the same bits for any number of threads", "[steering]") {
    Scene scene = steering_tank(2.4, 1.6, 1.0, 0.1);  // 3840 particles, 15 blocks
    scene.fluid->steering.bodies = {{{1.2, 1.4, 0.8}, {0, 0, 0}, 0, 0.2, 3000}};
    scene.fluid->steering.classes = {{0.3, 1.1, 0.8}};
    const auto run = [&](int threads) {
        omp_set_num_threads(threads);
        SteeringWorld world(scene);
        advance(world, 0.4);
        return world.particles().x;
    };
    const int before = omp_get_max_threads();
    const auto one = run(1);
    CHECK(one == run(2));
    CHECK(one == run(5));
    omp_set_num_threads(before);
}

TEST_CASE("recycling keeps the count, and the outflow goes back to the stock", "[steering]") {
    const Scene scene = steering_river(Flow::emitter);
    SteeringWorld world(scene);
    for (int k = 0; k < 20; ++k) {
        advance(world, 0.5);
        CHECK(world.particles().count + world.emitter().stock == 1200);
    }
    CHECK(world.emitter().recycled > 100);
    CHECK(world.emitter().layers_missed == 0);
}

TEST_CASE("a recirculating river keeps its bulk speed and its particles", "[steering]") {
    const Scene scene = steering_river(Flow::recirculating);
    SteeringWorld world(scene);
    const std::size_t n = world.particles().count;
    advance(world, 5);
    CHECK(world.particles().count == n);
    double speed = 0;
    for (std::size_t i = 0; i < n; ++i) speed -= static_cast<double>(world.particles().vx[i]) / static_cast<double>(n);
    CHECK(speed == Approx(1.5).epsilon(0.01));
}

TEST_CASE("lists that serve several steps hold all neighbours all the while", "[steering]") {
    Scene scene = steering_river(Flow::recirculating);
    scene.fluid->steering.classes = {{0.5, 1.2, 1}};
    SteeringWorld world(scene);
    int reused = 0;
    for (int k = 0; k < 60; ++k) {
        const steering::SteeringStep step = world.step(1.0 / 30);
        reused += step.new_lists ? 0 : 1;
        if (k % 10 != 9) continue;
        const Particles& p = world.particles();
        std::size_t n = 0;
        const double reach = world.settings().reach;
        for (std::size_t i = 0; i < p.count; ++i) {
            for (std::size_t j = 0; j < p.count; ++j) {
                double dx = static_cast<double>(p.x[i] - p.x[j]);
                dx -= 6 * std::round(dx / 6);
                const double dy = static_cast<double>(p.y[i] - p.y[j]), dz = static_cast<double>(p.z[i] - p.z[j]);
                n += i != j && dx * dx + dy * dy + dz * dz < reach * reach ? 1 : 0;
            }
        }
        // Rounding at the very reach.
        CHECK(world.neighbours() * static_cast<double>(p.count) == Approx(static_cast<double>(n)).margin(3));
    }
    CHECK(reused > 5);
}

TEST_CASE("no particle is faster than max_speed or is accelerated by more than max_force and gravity", "[steering]") {
    Scene scene = steering_tank(0.8, 0.8, 0.8, 0.1);
    scene.channel->water_blocks[0].y_min = 3;
    scene.fluid->steering.max_speed = 0.5;
    SteeringWorld world(scene);
    advance(world, 1.2);
    const auto fastest = static_cast<double>(world.settings().max_speed);
    CHECK(fastest == Approx(0.5 * std::sqrt(9.81 * 3.8)).epsilon(1e-5));
    double seen = 0;
    for (std::size_t i = 0; i < world.particles().count; ++i) {
        const Particles& p = world.particles();
        seen =
            std::max(seen, std::sqrt(static_cast<double>(p.vx[i] * p.vx[i] + p.vy[i] * p.vy[i] + p.vz[i] * p.vz[i])));
    }
    CHECK(seen <= fastest * (1 + 1e-5));
    CHECK(seen > 0.2 * fastest);

    // Two particles almost at one position, with the smallest force: in one step they part no faster than it allows.
    scene = steering_tank(0.8, 0.8, 0.1, 0.1);
    scene.channel->water_blocks = {{{0.3, 0.4}, {0.3, 0.4}, 0.1, 0.3}};
    scene.fluid->steering.max_force = 0.01;
    SteeringWorld few(scene);
    few.particles().add({few.particles().x[0] + 0.02F, few.particles().y[0], few.particles().z[0]}, {0, 0, 0},
                        Kind::fluid);
    steering::radius_factors(few.particles())[1] = 1;
    steering::mass_factors(few.particles())[1] = 1;
    const steering::SteeringStep step = few.step(1.0 / 30);
    const double most = static_cast<double>(few.settings().max_acceleration) * step.dt;
    CHECK(std::abs(static_cast<double>(few.particles().vx[0])) == Approx(most).epsilon(1e-3));
}

TEST_CASE("of two liquids the one of smaller mass ends above the other", "[steering]") {
    Scene scene = steering_tank(0.8, 0.8, 0.8, 0.1);
    scene.fluid->steering.classes = {{0.5, 1, 0.25}};
    SteeringWorld world(scene);
    const auto mean_heights = [&] {
        std::array<double, 2> sum{}, n{};
        for (std::size_t i = 0; i < world.particles().count; ++i) {
            const std::size_t light = steering::mass_factors(world.particles())[i] < 1 ? 1 : 0;
            sum[light] += static_cast<double>(world.particles().y[i]);
            n[light] += 1;
        }
        return std::array<double, 2>{sum[0] / n[0], sum[1] / n[1]};
    };
    const auto before = mean_heights();
    CHECK(std::abs(before[0] - before[1]) < 0.08);
    advance(world, 10);
    const auto after = mean_heights();
    CHECK(after[1] > after[0]);
}
