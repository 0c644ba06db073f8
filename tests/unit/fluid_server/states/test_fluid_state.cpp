#include <catch2/catch.hpp>
#include <functional>
#include <string>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "fluid_server/dfsph/dfsph_model.hpp"
#include "fluid_server/kinematic/kinematic_stream.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;
using Catch::Matchers::Contains;

namespace {

void run_frames(fluid::FluidModel& model, std::uint64_t frames) {
    for (std::uint64_t f = 1; f <= frames; ++f) model.advance_frame({(f - 1) * 100'000, f * 100'000, 3'000'000});
}

bool same_bits(const FluidState& a, const FluidState& b) {
    const std::size_t n = a.particles.count;
    bool same = n == b.particles.count && a.time == b.time && a.frame == b.frame &&
                a.position_clamps == b.position_clamps && a.emitter.has_value() == b.emitter.has_value();
    if (same && a.emitter) {
        same = a.emitter->last_layer_x == b.emitter->last_layer_x && a.emitter->stock == b.emitter->stock &&
               a.emitter->recycled == b.emitter->recycled && a.emitter->layers_missed == b.emitter->layers_missed;
    }
    const auto end = static_cast<std::ptrdiff_t>(n);
    for (const auto& [name, values] : particle_arrays) {
        const auto& here = a.particles.*values;
        same = same && std::equal(here.begin(), here.begin() + end, (b.particles.*values).begin());
    }
    return same && std::equal(a.particles.kind.begin(), a.particles.kind.begin() + end, b.particles.kind.begin());
}

// A channel that recycles particles within two seconds, with an obstacle.
Scene short_channel() {
    Scene scene = test::emitter_channel(2.5, 9.81, 2000);
    scene.obstacles = {{{4, 6}, {1, 2.5}, 1}};
    return scene;
}

// Six metres of water that are thrown against a wall, with a solve that may not iterate.
Scene failing_column() {
    Scene scene = test::tank(3, 1, 6, 0.2);
    WaterBlock& water = scene.channel->water_blocks[0];
    water.x.lo = 2;
    water.velocity = {-20, 0, 0};
    scene.fluid->cfl = 2;
    scene.fluid->density_solve = {0.1, 1, 1};
    scene.fluid->divergence_solve.max_iterations = 0;
    return scene;
}

}  // namespace

TEST_CASE("a run that goes on from a state has the same bits as one without a break", "[fluid][state]") {
    for (const Scene& scene : {short_channel(), test::tank(1, 0.6, 0.5, 0.1)}) {
        DfsphModel whole(scene);
        run_frames(whole, 120);
        CHECK((!whole.state()->emitter || whole.state()->emitter->recycled > 0));

        DfsphModel first(scene);
        run_frames(first, 60);
        DfsphModel second(scene);
        second.restore(*first.state(), "test");
        CHECK(same_bits(*second.state(), *first.state()));
        run_frames(second, 60);
        CHECK(second.state()->frame == 120);
        CHECK(same_bits(*second.state(), *whole.state()));
    }
}

TEST_CASE("the stock takes up another max_particles", "[fluid][state]") {
    Scene scene = short_channel();
    FluidWorld world(scene);
    FluidState state;
    world.capture(state);
    const std::uint64_t stock = world.emitter().stock;
    scene.fluid->max_particles += 500;
    FluidWorld larger(scene);
    larger.restore(state, "test");
    CHECK(larger.emitter().stock == stock + 500);
    CHECK(larger.particles().count + larger.emitter().stock == 2500);

    scene.fluid->max_particles = static_cast<int>(state.particles.count);
    FluidWorld exact(scene);
    exact.restore(state, "test");
    CHECK(exact.emitter().stock == 0);
}

TEST_CASE("a state of a site goes on with the same bits, and on no other ground, among no other houses",
          "[fluid][state]") {
    Scene scene;
    scene.world->length = 8, scene.world->width = 6;
    scene.channel->flow = Flow::closed;
    scene.channel->x = {0, 8}, scene.channel->z = {0, 6};
    scene.fluid = test::fluid_of(0.25, 8000);
    Site& site = scene.site.emplace();
    site.ground.slope_x = 0.05;
    site.roughness.n = 0.03;
    site.water = {{{}, 0.8}};
    site.houses.resize(1);
    site.houses[0].polygon.rings = {{{3, 2}, {5, 2.5}, {4.5, 4.5}, {2.5, 4}}};
    site.sources.resize(1);
    site.sources[0].line = {{8, 2}, {8, 4}};
    site.sources[0].discharge = {{0, 2}};
    site.outlets.resize(1);
    site.outlets[0].line = {{0, 0}, {0, 6}};
    DfsphModel whole(scene), first(scene);
    run_frames(whole, 8);
    run_frames(first, 4);
    const FluidState state = *first.state();
    DfsphModel later(scene);
    later.restore(state, "test");
    for (std::uint64_t f = 5; f <= 8; ++f) static_cast<void>(later.advance_frame({f - 1, f, 30}));
    const Particles &a = whole.world().particles(), &b = later.world().particles();
    REQUIRE(a.count == b.count);
    CHECK(std::equal(a.x.begin(), a.x.begin() + static_cast<std::ptrdiff_t>(a.count), b.x.begin()));
    CHECK(std::equal(a.vy.begin(), a.vy.begin() + static_cast<std::ptrdiff_t>(a.count), b.vy.begin()));
    CHECK_THAT(whole.remarks(), Contains("m3 came in"));

    const auto refused = [&](const std::function<void(Site&)>& change, const std::string& text) {
        Scene other = scene;
        change(*other.site);
        FluidWorld world(other);
        CHECK_THROWS_WITH(world.restore(state, "test"), Contains(text));
    };
    refused([](Site& p) { p.ground.slope_x = 0.06; }, "/site/ground/slope_x is 0.05 in this file and 0.06");
    refused([](Site& p) { p.houses.clear(); }, "/site/houses has 1 entries in this file and 0 in the scene");
    refused([](Site& p) { p.houses[0].polygon.rings[0][1].x = 5.5; },
            "/site/houses/0/polygon/1/0 is 5 in this file and 5.5 in the scene");
    refused([](Site& p) { p.barriers.resize(1); }, "/site/gates has 0 entries");
}

TEST_CASE("a state is refused where its water cannot go on, with key and both values", "[fluid][state]") {
    const Scene scene = short_channel();
    DfsphModel model(scene);
    run_frames(model, 3);
    const FluidState state = *model.state();
    const auto refused = [&](const std::function<void(Scene&)>& change, const std::string& text) {
        Scene other = scene;
        change(other);
        FluidWorld world(other);
        CHECK_THROWS_AS(world.restore(state, "test"), ConfigurationError);
        CHECK_THROWS_WITH(world.restore(state, "test"), Contains(text));
    };
    refused(
        [](Scene& s) { s.fluid->particle_spacing = 0.5; },
        "test: /fluid/particle_spacing_m is 0.4642 in this file and 0.5 in the scene; allowed in the scene: 0.4642");
    refused([](Scene& s) { s.fluid->rest_density = 900; }, "/fluid/rest_density_kg_m3 is 1000 in this file and 900");
    refused(
        [](Scene& s) { s.fluid->kernel = KernelKind::wendland_c2; },
        "/fluid/kernel is cubic_spline in this file and wendland_c2 in the scene; allowed in the scene: cubic_spline");
    refused([](Scene& s) { s.fluid->support_in_spacings = 2.1; },
            "/fluid/support_in_spacings is 2 in this file and 2.1 in the scene; allowed in the scene: 2");
    refused([](Scene& s) { s.channel->x.lo = -1; },
            "/channel/x_min_m is 0 in this file and -1 in the scene; allowed in the scene: 0");
    refused([](Scene& s) { s.channel->z.hi = 5; },
            "/channel/z_max_m is 4 in this file and 5 in the scene; allowed in the scene: 4");
    refused([](Scene& s) { s.channel->flow = Flow::closed; },
            "/channel/flow is emitter in this file and closed in the scene; allowed in the scene: emitter");
    refused([](Scene& s) { s.channel->depth = 0.5; }, "/channel/depth_m is 1 in this file and 0.5");
    refused([](Scene& s) { s.obstacles.clear(); },
            "/obstacles has 1 entries in this file and 0 in the scene; allowed in the scene: 1");
    refused([](Scene& s) { s.obstacles[0].x.hi = 7; },
            "/obstacles/0/x_max_m is 6 in this file and 7 in the scene; allowed in the scene: 6");

    Scene small = scene;
    small.fluid->max_particles = static_cast<int>(state.particles.count) - 1;
    CHECK_THROWS_WITH(
        check_state_fits(state, small, "test"),
        Contains("/fluid/max_particles is 2000 in this file and " + std::to_string(small.fluid->max_particles)) &&
            Contains("at least " + std::to_string(state.particles.count)));
}

TEST_CASE("solver settings, viscosity and length of the run may differ from those of the state", "[fluid][state]") {
    Scene scene = short_channel();
    DfsphModel model(scene);
    run_frames(model, 3);
    scene.fluid->cfl = 0.2;
    scene.fluid->density_solve = {1e-4, 3, 200};
    scene.fluid->kinematic_viscosity = 0.02;
    scene.duration = 10;
    scene.channel->velocity = 1;
    DfsphModel other(scene);
    other.restore(*model.state(), "test");
    run_frames(other, 1);
    CHECK(other.state()->frame == 4);
}

TEST_CASE("water that is not solved has no state", "[fluid][state]") {
    Scene scene = short_channel();
    DfsphModel model(scene);
    const FluidState state = *model.state();
    scene.obstacles.clear();
    scene.fluid->model = wade::ModelKind::kinematic;
    KinematicStream stream(scene);
    CHECK(stream.state() == nullptr);
    CHECK(stream.states_before_failure().frame_begin == nullptr);
    CHECK_THROWS_WITH(stream.restore(state, "test"), Contains("/fluid/model is kinematic; allowed: dfsph"));
}

TEST_CASE("a frame that fails says so and keeps the state at its begin and the last sound one", "[fluid][state]") {
    const Scene scene = failing_column();
    DfsphModel model(scene);
    std::string what;
    try {
        run_frames(model, 60);
    } catch (const RunError& error) {
        CHECK(error.code() == ExitCode::numerical_failure);
        what = error.what();
    }
    const FailureStates states = model.states_before_failure();
    REQUIRE(states.frame_begin != nullptr);
    REQUIRE(states.last_sound != nullptr);
    const std::uint64_t frame = states.frame_begin->frame + 1;
    CHECK_THAT(what, Contains("failed in frame " + std::to_string(frame) + ", at t = ") && Contains("compressed by") &&
                         Contains("change /fluid/cfl from 2 to 0.5"));
    CHECK(states.last_sound->frame < frame);

    // The same again from the begin of the frame and from the sound state.
    for (const FluidState* state : {states.frame_begin, states.last_sound}) {
        DfsphModel again(scene);
        again.restore(*state, "test");
        CHECK_THROWS_WITH(run_frames(again, 60), what);
        CHECK(same_bits(*again.states_before_failure().frame_begin, *states.frame_begin));
    }
    Scene better = scene;
    better.fluid->cfl = 0.5;
    better.fluid->density_solve = test::tank(1, 1, 6, 0.2).fluid->density_solve;
    DfsphModel healed(better);
    healed.restore(*states.last_sound, "test");
    CHECK_NOTHROW(run_frames(healed, 60));
    CHECK(healed.states_before_failure().frame_begin == nullptr);
}

TEST_CASE("a particle that leaps over its neighbours in one step is a numerical failure", "[fluid][state][errors]") {
    // Five particles lie almost at one position. The gradients that should part them nearly vanish, pressure does not.
    // The others, alone, keep the mean compression small.
    Scene scene = test::tank(10, 10, 1, 0.25);
    scene.world->gravity = 1;
    FluidWorld world(scene);
    FluidState state;
    world.capture(state);
    Particles& p = state.particles;
    p.count = 0;
    for (int i = 0; i < 10; ++i) {
        for (int k = 0; k < 10; ++k) {
            p.add({0.5F + static_cast<float>(i), 0.5F, 0.5F + static_cast<float>(k)}, {}, Kind::fluid);
        }
    }
    for (int n = 0; n < 5; ++n) p.add({0.5F + 1e-5F * static_cast<float>(n), 0.5F, 0.5F}, {}, Kind::fluid);
    world.restore(state, "test");
    CHECK_THROWS_WITH(world.step(0.1), Contains("in one step, further than the support radius of 0.5 m") &&
                                           Contains("change /fluid/cfl from 0.4 to 0.2"));
}

TEST_CASE("the largest displacement of a step is reported", "[fluid][time_step]") {
    const Scene scene = test::tank(1, 1, 1, 0.1);
    FluidWorld world(scene);
    FluidState state;
    world.capture(state);
    for (std::size_t i = 0; i < state.particles.count; ++i) state.particles.vz[i] = i == 7 ? -0.5F : 0.0F;
    world.restore(state, "test");
    const StepReport report = world.step(0.001);
    CHECK(report.max_displacement > 0.5 * 0.5 * report.dt);
    CHECK(report.max_displacement < 2 * 0.5 * report.dt);
    CHECK(world.time() == report.dt);
}
