// The client's loop, fed with frames that are made up.

#include <catch2/catch.hpp>
#include <csignal>
#include <limits>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/crowd.hpp"
#include "crowd_client/session/run_crowds.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::MadeUpSource;
using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::one_agent_scene;

namespace {

MadeUpWater dry(std::uint64_t) {
    return {};
}

Scene short_scene(double duration) {
    Scene scene = one_agent_scene(10, 25, 75, 50, 0.2);
    scene.duration = duration;
    return scene;
}

}  // namespace

TEST_CASE("A run ends as completed after its last frame, with all frames released") {
    CrowdRun one{.crowd = make_crowd(short_scene(1))};
    MadeUpSource source(1000, dry);
    const RunSummary& summary = one.summary;
    run_crowds({&one, 1}, source);
    CHECK(summary.status == "completed");
    CHECK(summary.frames == 30);
    CHECK(source.released == 30);
    CHECK(source.left);
    CHECK(source.abort_code == 0);
    CHECK(summary.frame_hash == 1030);
}

TEST_CASE("A final frame at the end of the duration needs no goodbye") {
    CrowdRun one{.crowd = make_crowd(short_scene(1))};
    MadeUpSource source(30, dry);
    const RunSummary& summary = one.summary;
    run_crowds({&one, 1}, source);
    CHECK(summary.status == "completed");
    CHECK_FALSE(source.left);
}

TEST_CASE("A stream that ends early is told apart from a completed run") {
    CrowdRun one{.crowd = make_crowd(short_scene(1))};
    MadeUpSource source(12, dry);
    const RunSummary& summary = one.summary;
    run_crowds({&one, 1}, source);
    CHECK(summary.status == "stream_ended");
    CHECK(summary.frames == 12);
}

TEST_CASE("A run ends when no agent is active, if the scene says so") {
    Scene scene = one_agent_scene(74, 45, 75, 50, 0);
    scene.duration = 10;
    for (const bool stop : {true, false}) {
        scene.stop_when_no_agent_is_active = stop;
        CrowdRun one{.crowd = make_crowd(scene)};
        CrowdWorld& crowd = one.crowd;
        MadeUpSource source(1000, dry);
        const RunSummary& summary = one.summary;
        run_crowds({&one, 1}, source);
        CHECK(summary.status == "completed");
        CHECK(crowd.arrived == 1);
        CHECK((summary.frames < 300) == stop);
    }
}

TEST_CASE("A scene without agents runs for its whole duration") {
    Scene scene = short_scene(1);
    scene.crowd->groups.clear();
    CrowdRun one{.crowd = make_crowd(scene)};
    MadeUpSource source(1000, dry);
    const RunSummary& summary = one.summary;
    run_crowds({&one, 1}, source);
    CHECK(summary.frames == 30);
    CHECK(summary.status == "completed");
}

TEST_CASE("A signal between two frames ends the run and tells the producer") {
    for (const int signal : {SIGINT, SIGTERM}) {
        CrowdRun one{.crowd = make_crowd(short_scene(1))};
        MadeUpSource source(1000, dry);
        const RunSummary& summary = one.summary;
        RunHooks hooks;
        hooks.interrupted = [&] { return summary.frames == 7 ? signal : 0; };
        const int code = signal == SIGINT ? 130 : 143;
        try {
            run_crowds({&one, 1}, source, hooks);
            FAIL("the run went on");
        } catch (const RunError& error) {
            CHECK(static_cast<int>(error.code()) == code);
        }
        CHECK(summary.frames == 7);
        CHECK(source.abort_code == code);
        CHECK(source.abort_text.find("after frame 7") != std::string::npos);
    }
}

TEST_CASE("A failing log ends the run and tells the producer why") {
    CrowdRun one{.crowd = make_crowd(short_scene(1))};
    CrowdWorld& crowd = one.crowd;
    MadeUpSource source(1000, dry);
    RunHooks hooks;
    hooks.on_step = [&](std::size_t, const WaterView&) {
        if (crowd.steps == 5) throw RunError(ExitCode::unexpected, "no space left");
    };
    CHECK_THROWS_WITH(run_crowds({&one, 1}, source, hooks), "no space left");
    CHECK(source.abort_code == 1);
    CHECK(source.abort_text == "no space left");
}

TEST_CASE("A frame out of turn is a violation of the protocol") {
    CrowdRun one{.crowd = make_crowd(short_scene(1))};
    MadeUpSource source(1000, dry);
    source.number_of_next = 2;
    CHECK_THROWS_WITH(run_crowds({&one, 1}, source), "got frame 2 of the water where frame 1 was due");
    CHECK(source.abort_code == 6);
}

TEST_CASE("The log sees each step once, in order, before its frame is released") {
    CrowdRun one{.crowd = make_crowd(short_scene(1))};
    CrowdWorld& crowd = one.crowd;
    MadeUpSource source(
        30, [](std::uint64_t f) { return testing::uniform_water(0, 1, 0, 1, 0.5, 0.5, static_cast<double>(f), 0); });
    RunHooks hooks;
    std::uint64_t expected = 0;
    hooks.on_step = [&](std::size_t, const WaterView& water) {
        ++expected;
        REQUIRE(crowd.steps == expected);
        REQUIRE(source.released == expected - 1);
        REQUIRE(static_cast<double>(water.vx[0]) == static_cast<double>(expected));
    };
    run_crowds({&one, 1}, source, hooks);
    CHECK(expected == 30);
}

TEST_CASE("Commands are taken before each frame, before it is asked for") {
    CrowdRun one{.crowd = make_crowd(short_scene(1))};
    MadeUpSource source(30, dry);
    RunHooks hooks;
    std::uint64_t calls = 0;
    hooks.before_frame = [&] { REQUIRE(source.number_of_next == ++calls); };
    run_crowds({&one, 1}, source, hooks);
    CHECK(calls == 30);
}

TEST_CASE("A signal that comes with the commands ends the run before the next frame") {
    CrowdRun one{.crowd = make_crowd(short_scene(1))};
    MadeUpSource source(30, dry);
    const RunSummary& summary = one.summary;
    RunHooks hooks;
    int signal = 0;
    hooks.before_frame = [&] { signal = summary.frames == 3 ? SIGINT : 0; };
    hooks.interrupted = [&] { return signal; };
    CHECK_THROWS_WITH(run_crowds({&one, 1}, source, hooks), Catch::Contains("after frame 3"));
    CHECK(source.number_of_next == 4);
}

TEST_CASE("The summary of the water averages what frames gave after the first second") {
    FluidSummary summary;
    const double dt = 0.5;
    const auto frame_with = [](std::uint32_t count, std::uint32_t steps, double mean_error, double max_error,
                               double depth) {
        shm::Frame f;
        f.count = count;
        f.diagnostics.sub_steps = steps;
        f.diagnostics.mean_density_error = mean_error;
        f.diagnostics.max_density_error = max_error;
        f.diagnostics.mean_depth_m = depth;
        f.diagnostics.solver_ns = 1000;
        return f;
    };
    add_frame(summary, frame_with(100, 2, 0.5, 0.9, 7), 0.5, dt);
    add_frame(summary, frame_with(300, 2, 0.5, 0.9, 7), 1.0, dt);
    add_frame(summary, frame_with(200, 1, 0.01, 0.02, 1.0), 1.5, dt);
    add_frame(summary, frame_with(200, 3, 0.03, 0.05, 0.8), 2.0, dt);
    add_frame(summary, frame_with(200, 3, 0.03, 0.04, std::numeric_limits<double>::quiet_NaN()), 2.5, dt);
    CHECK(summary.particles_max == 300);
    CHECK(summary.steps == 11);
    CHECK(summary.particle_steps == 100 * 2 + 300 * 2 + 200 * 7);
    CHECK(summary.solver_ns == 5000);
    CHECK(summary.density_error.value().value() == Approx((0.01 + 3 * 0.03 + 3 * 0.03) / 7));
    CHECK(summary.max_density_error.value() == 0.05);
    CHECK(summary.depth.value().value() == Approx(0.9));
    CHECK_FALSE(summary.speed.value().has_value());
}
