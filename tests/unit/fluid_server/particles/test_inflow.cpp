#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <vector>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "fluid_server/dfsph/fluid_world.hpp"
#include "fluid_server/particles/emitter.hpp"
#include "fluid_server/particles/inflow.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;

namespace {

// Still until 1 s, up to 2 m/s at 2 s, stopped at once at 3 s, 1 m/s from 4 s on.
const std::vector<VelocityPoint> stop_and_go{{1, 0}, {2, 2}, {3, 2}, {3, 0}, {4, 0}, {4, 1}};

// Its integral from 0 to t.
double way(double t) {
    const double rise = std::clamp(t - 1, 0.0, 1.0);
    return rise * rise + 2 * std::clamp(t - 2, 0.0, 1.0) + std::max(t - 4, 0.0);
}

Scene emitter_scene(const std::vector<VelocityPoint>& history, int capacity) {
    Scene scene = test::emitter_channel(0, 9.81, capacity);
    scene.channel->velocity_history = history;
    return scene;
}

std::size_t count_kind(const Particles& p, Kind kind) {
    return static_cast<std::size_t>(
        std::count(p.kind.begin(), p.kind.begin() + static_cast<std::ptrdiff_t>(p.count), kind));
}

// Sub-steps to the next whole frame of 1/30 s, then calls `check`.
void run_frames(FluidWorld& world, int frames, const std::function<void()>& check) {
    for (int f = 0; f < frames; ++f) {
        double remaining = 1.0 / 30;
        while (remaining > 1e-12) {
            remaining -= world.step(remaining).dt;
        }
        check();
    }
}

}  // namespace

TEST_CASE("v_F in time is straight between its points and constant beyond them", "[fluid][inflow]") {
    Channel channel;
    channel.velocity = 3;
    CHECK(velocity_at(channel, 5) == 3);
    CHECK(mean_velocity(channel, 5, 6) == 3);
    CHECK(largest_velocity(channel) == 3);
    channel.velocity = 0;
    channel.velocity_history = stop_and_go;
    CHECK(velocity_at(channel, 0) == 0);
    CHECK(velocity_at(channel, 1.5) == 1);
    CHECK(velocity_at(channel, 2.9) == 2);
    CHECK(velocity_at(channel, 3) == 0);  // the later of two points
    CHECK(velocity_at(channel, 4) == 1);
    CHECK(velocity_at(channel, 1000) == 1);
    CHECK(largest_velocity(channel) == 2);
    CHECK(largest_velocity(channel, 3.5, 4) == 1);
    CHECK(largest_velocity(channel, 0, 1) == 0);
}

TEST_CASE("the mean of v_F over any steps adds up to its integral", "[fluid][inflow]") {
    Channel channel;
    channel.velocity_history = stop_and_go;
    CHECK(mean_velocity(channel, 3, 4) == 0);
    CHECK(mean_velocity(channel, 2, 3) == 2);
    CHECK(mean_velocity(channel, 1.5, 1.5) == 1);
    for (const double dt : {0.013, 0.1, 0.25, 1.7}) {
        double sum = 0, t = 0;
        while (t < 6) {
            sum += dt * mean_velocity(channel, t, t + dt);
            t += dt;
            REQUIRE(sum == Approx(way(t)).margin(1e-12));
        }
    }
}

TEST_CASE("an emitter delivers the integral of v_F, layer by layer", "[fluid][inflow][emitter]") {
    const Scene scene = emitter_scene(stop_and_go, 5000);
    Particles p(5000);
    Emitter emitter(scene, 0);
    emitter.emit(p, 0);
    const std::size_t layer = 2 * 9;  // 1 m x 4 m at 0.4642 m
    REQUIRE(p.count == 4 * layer);
    const double pitch = static_cast<double>(layer) * std::pow(scene.fluid->particle_spacing, 3) / 4;
    double t = 0;
    const double dt = 0.01;
    for (int n = 0; n < 600; ++n, t += dt) {
        emitter.set_velocity(p, mean_velocity(scene.channel, t, t + dt));
        for (std::size_t i = 0; i < p.count; ++i) {
            p.x[i] += static_cast<float>(dt) * p.vx[i];
        }
        emitter.emit(p, static_cast<float>(dt));
        // The first layer waits half a pitch behind the opening.
        const auto passed = static_cast<std::size_t>(way(t + dt) / pitch + 0.5 + 1e-4);
        const auto passed_at_least = static_cast<std::size_t>(way(t + dt) / pitch + 0.5 - 1e-4);
        const std::size_t fluid = count_kind(p, Kind::fluid);
        REQUIRE(fluid <= passed * layer);
        REQUIRE(fluid >= passed_at_least * layer);
        REQUIRE(p.count == fluid + 4 * layer);
    }
    CHECK(emitter.state()->layers_missed == 0);
}

TEST_CASE("the waiting layers reach further than the kernel", "[fluid][inflow][emitter]") {
    Scene scene = emitter_scene({{0, 1}}, 5000);
    scene.fluid->kernel = KernelKind::wendland_c2;
    Particles p(5000);
    Emitter emitter(scene, 0);
    emitter.emit(p, 0);
    CHECK(p.count == 5 * 18);
    for (int n = 0; n < 500; ++n) {
        emitter.set_velocity(p, 0.7);
        for (std::size_t i = 0; i < p.count; ++i) {
            p.x[i] += 0.01F * p.vx[i];
        }
        emitter.emit(p, 0.01F);
        const float rearmost = *std::max_element(p.x.begin(), p.x.begin() + static_cast<std::ptrdiff_t>(p.count));
        REQUIRE(rearmost >= 10 + 3 * 0.44F);  // the pitch is 0.45 m
    }
}

TEST_CASE("a river that starts from nothing, stops and starts again gets the mass of its inflow",
          "[fluid][inflow][emitter]") {
    const Scene scene = emitter_scene(stop_and_go, 2000);
    FluidWorld world(scene);
    const std::size_t layer = 2 * 9;
    const double volume = std::pow(scene.fluid->particle_spacing, 3);
    run_frames(world, 200, [&] {
        const Particles& p = world.particles();
        REQUIRE(p.count + world.emitter().stock == 2000);
        const double delivered = static_cast<double>(count_kind(p, Kind::fluid) + world.emitter().recycled) * volume;
        REQUIRE(std::abs(delivered - 4 * way(world.time())) <= static_cast<double>(layer) * volume);
        REQUIRE(count_kind(p, Kind::inflow) == 4 * layer);
        float nearest = 100;
        for (std::size_t i = 0; i < p.count; ++i) {
            if (p.kind[i] == Kind::inflow) {
                nearest = std::min(nearest, p.x[i]);
            }
        }
        REQUIRE(nearest > 10);
    });
    CHECK(world.time() == Approx(200.0 / 30));
    CHECK(world.emitter().layers_missed == 0);
    CHECK(world.position_clamps() == 0);
}

TEST_CASE("a history of one velocity is that velocity, to the bit", "[fluid][inflow]") {
    const auto final_state = [](double velocity, const std::vector<VelocityPoint>& history) {
        Scene scene = emitter_scene(history, 2000);
        scene.channel->velocity = velocity;
        FluidWorld world(scene);
        run_frames(world, 60, [] {});
        return world.particles().x;
    };
    CHECK(final_state(1.5, {}) == final_state(0, {{0, 1.5}}));
}

TEST_CASE("a recirculating river follows v_F in time", "[fluid][inflow]") {
    Scene scene = test::tank(4, 2, 1, 0.25);
    scene.channel->water_blocks.clear();
    scene.channel->flow = Flow::recirculating;
    scene.channel->initial_river = InitialRiver::filled;
    scene.channel->velocity_history = {{0, 0}, {1, 2}};
    FluidWorld world(scene);
    run_frames(world, 60, [&] {
        double speed = 0;
        const Particles& p = world.particles();
        for (std::size_t i = 0; i < p.count; ++i) {
            speed -= static_cast<double>(p.vx[i]) / static_cast<double>(p.count);
        }
        REQUIRE(speed == Approx(velocity_at(scene.channel, world.time())).margin(0.01));
    });
}

TEST_CASE("an inflow that jumps up does not outrun the time step", "[fluid][inflow][time_step]") {
    Scene scene = emitter_scene({{0.5, 0}, {0.5, 20}}, 2000);
    FluidWorld world(scene);
    // cfl d / (20 m/s + sqrt(g H)) in the frame that ends with the jump, and from then on
    const double limit = 0.4 * 0.4642 / (20 + std::sqrt(9.81));
    for (int n = 0; n < 60; ++n) {
        const double from = world.time();
        const double dt = world.step(1.0 / 30).dt;
        if (from > 0.5 - 1.0 / 30) {
            REQUIRE(dt <= limit * (1 + 1e-9));
        }
    }
}

TEST_CASE("what leaves at the outlet does not come back, also when the water turns round", "[fluid][emitter]") {
    Scene scene = test::emitter_channel(0.5, 9.81, 2000);
    scene.channel->initial_river = InitialRiver::filled;
    FluidWorld world(scene);
    for (int round = 0; round < 3; ++round) {
        // All of the water moves away from the outlet, piles up at the emitter, and comes back as a wave.
        world.set_velocity([](const std::array<double, 3>& place) {
            return std::array<double, 3>{place[0] > 10 ? -0.5 : 3, 0, 0};  // not the layers that wait in the emitter
        });
        std::uint64_t recycled = world.emitter().recycled;
        run_frames(world, 150, [&] {
            const Particles& p = world.particles();
            REQUIRE(p.count + world.emitter().stock == 2000);
            REQUIRE(world.emitter().recycled >= recycled);
            recycled = world.emitter().recycled;
            for (std::size_t i = 0; i < p.count; ++i) {
                const bool finite = std::isfinite(p.x[i] + p.y[i] + p.z[i]);
                const bool inside =
                    p.y[i] > 0 && p.z[i] > 0 && p.z[i] < 4 && (p.kind[i] == Kind::inflow || p.x[i] <= 10);
                REQUIRE((finite && inside));
            }
        });
    }
    CHECK(world.emitter().recycled > 0);
    CHECK(world.position_clamps() == 0);
}
