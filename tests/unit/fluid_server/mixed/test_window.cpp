// The window follows the agents, and nothing is lost when it does.

#include <omp.h>

#include <array>
#include <catch2/catch.hpp>
#include <vector>

#include "configs/scene/coupling.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "mixed_waters.hpp"
#include "shm_protocol/layout.hpp"
#include "tests/unit/fluid_server/frame_arrays.hpp"

using namespace wade;
using namespace wade::fluid;
using namespace wade::fluid::mixed;
using wade::fluid::test::FrameArrays;

namespace {

// One agent.
struct Someone {
    std::array<float, 1> x{}, z{3.0F}, state{static_cast<float>(shm::agent_walking)}, other{};

    [[nodiscard]] AgentsView view() const {
        AgentsView agents;
        agents.px = x, agents.pz = z, agents.state = state;
        agents.py = agents.vx = agents.vy = agents.vz = agents.mass = agents.radius = agents.height = other;
        return agents;
    }
};

FrameInterval frame(std::uint64_t number) {
    return {number - 1, number, 30};
}

Scene followed_river() {
    Scene scene = river(60, 1, 0, 1.5);  // no fixed window
    scene.coupling->agents_stream = AgentsStream::serial;
    scene.fluid->particle_spacing = 0.4642;
    return scene;
}

// One agent walks up the river, down again, out of it and in again.
std::vector<float> walk_along(const Scene& scene) {
    MixedModel model(scene);
    FrameArrays arrays(model);
    Someone agent;
    const double volume = model.world().volume(), density = scene.fluid->rest_density;
    std::vector<float> seen;
    std::vector<std::size_t> begins;
    for (std::uint64_t f = 1; f <= 360; ++f) {
        const double t = static_cast<double>(f) / 30;
        agent.x[0] = static_cast<float>(30 + 15 * std::sin(t));
        agent.z[0] = f > 300 && f < 330 ? -20.0F : 3.0F;
        model.take_agents(agent.view());
        model.advance_frame(frame(f));
        arrays.take(model);
        // Particles are 0.1 m3 in single precision; their sum is in double.
        CHECK(model.world().volume() == Approx(volume).epsilon(1e-9));
        double owed = 0;
        for (const EndAccount& account : model.world().accounts()) owed += account.owed;
        CHECK(arrays.mass() == Approx(density * (volume - owed)).epsilon(1e-5));
        const Window& window = model.world().window();
        if (f > 300 && f < 330) {
            CHECK(window.empty());
        } else {
            CHECK(model.world().grid_water().grid.face_x(window.begin) <= static_cast<double>(agent.x[0]) - 3);
            CHECK(model.world().grid_water().grid.face_x(window.end) >= static_cast<double>(agent.x[0]) + 3);
        }
        begins.push_back(window.begin);
        for (const auto& array : arrays.particles()) seen.push_back(array.empty() ? 0 : array[array.size() / 2]);
    }
    int moves = 0;
    for (std::size_t i = 1; i < begins.size(); ++i) moves += begins[i] != begins[i - 1] ? 1 : 0;
    CHECK(moves > 10);
    CHECK(moves < 40);
    const Closure closure = closure_of(model.world());
    INFO(model.remarks());
    CHECK(closure.volume < 0.02);
    return seen;
}

}  // namespace

TEST_CASE("a window that follows somebody keeps the mass, awake and asleep", "[mixed]") {
    walk_along(followed_river());
}

TEST_CASE("the mixed water is the same to the last bit for any number of threads", "[mixed]") {
    const int before = omp_get_max_threads();
    std::vector<std::vector<float>> runs;
    for (const int threads : {1, 2, 3}) {
        omp_set_num_threads(threads);
        runs.push_back(walk_along(followed_river()));
    }
    omp_set_num_threads(before);
    CHECK(runs[0] == runs[1]);
    CHECK(runs[0] == runs[2]);
}

TEST_CASE("no people, no particles", "[mixed]") {
    MixedModel model(followed_river());
    for (std::uint64_t f = 1; f <= 30; ++f) model.advance_frame(frame(f));
    CHECK(model.world().window().empty());
    CHECK(model.world().particle_water().particles().count == 0);
}

TEST_CASE("the window keeps its guards out of obstacles and inside the channel", "[mixed]") {
    Scene scene = river(60, 1, 0, 1.5);
    scene.obstacles = {{{20, 22}, {2, 4}, 2}};
    scene.fluid->mixed.obstacles = true;
    scene.fluid->mixed.margin = 0;
    scene.fluid->max_particles = 40000;
    MixedWorld world(scene);
    const auto& grid = world.grid_water().grid;
    CHECK(grid.face_x(world.window().begin) < 20);
    CHECK(grid.face_x(world.window().end) > 22);
    CHECK(grid.face_x(world.window().begin) >= world.rule().guard());
    world.need(Interval{-5, 70});
    CHECK(grid.face_x(world.window().begin) >= world.rule().guard());
    CHECK(grid.face_x(world.window().end) <= 60 - world.rule().guard());
    run(world, 0.2);
    // No particle in the block.
    const Particles& p = world.particle_water().particles();
    for (std::size_t i = 0; i < p.count; ++i) {
        CHECK_FALSE((p.x[i] > 20.01F && p.x[i] < 21.99F && p.z[i] > 2.01F && p.z[i] < 3.99F && p.y[i] < 2));
    }
}
