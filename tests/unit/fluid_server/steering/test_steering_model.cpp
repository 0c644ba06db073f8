#include <catch2/catch.hpp>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "flock_pair.hpp"
#include "fluid_server/make_model.hpp"
#include "fluid_server/states/fluid_state.hpp"
#include "fluid_server/steering/steering_model.hpp"

using namespace wade;
using namespace wade::fluid;
using namespace wade::fluid::test;

TEST_CASE("the steering water is a model of the server: frames, masses, no state", "[steering]") {
    Scene scene = steering_tank(0.8, 0.8, 0.5, 0.1);
    scene.fluid->max_particles = 400;
    scene.fluid->steering.classes = {{0.5, 1, 2}};
    const auto model = make_fluid_model(scene);
    CHECK(model->name() == "steering");
    CHECK(model->capacity() == 400);
    CHECK(model->state() == nullptr);
    CHECK(model->remarks().empty());
    CHECK_THROWS_AS(model->restore(FluidState{}, "x"), ConfigurationError);
    const shm::Diagnostics d = model->advance_frame({0, 100, 3000});
    CHECK(d.sub_steps > 0);
    CHECK(d.mean_depth_m > 0.3);
    CHECK(d.kinetic_energy_j > 0);
    std::vector<std::vector<float>> fields(7, std::vector<float>(400));
    shm::FrameFields slot;
    slot.mass = fields[0];
    slot.vx = fields[1], slot.vy = fields[2], slot.vz = fields[3];
    slot.px = fields[4], slot.py = fields[5], slot.pz = fields[6];
    REQUIRE(model->write_frame(slot) == 320);
    int light = 0, heavy = 0;
    for (std::size_t i = 0; i < 320; ++i) {
        light += fields[0][i] == Approx(1) ? 1 : 0;
        heavy += fields[0][i] == Approx(2) ? 1 : 0;
        CHECK((fields[4][i] >= 0 && fields[4][i] <= 0.8F));
    }
    CHECK(light + heavy == 320);
    CHECK(std::abs(light - heavy) < 80);
}

TEST_CASE("particles beyond the outflow are in no frame", "[steering]") {
    Scene scene = emitter_channel(2, 9.81, 1500);
    scene.fluid->steering = steering_tank(1, 1, 1, 0.5).fluid->steering;
    scene.fluid->model = wade::ModelKind::steering;
    scene.channel->x = {2, 8};
    SteeringModel model(scene);
    std::vector<std::vector<float>> fields(7, std::vector<float>(1500));
    shm::FrameFields slot;
    slot.mass = fields[0];
    slot.vx = fields[1], slot.vy = fields[2], slot.vz = fields[3];
    slot.px = fields[4], slot.py = fields[5], slot.pz = fields[6];
    std::uint64_t recycled = 0;
    for (std::uint64_t f = 0; f < 180; ++f) {
        recycled = model.advance_frame({f, f + 1, 30}).recycled_particles;
        const std::uint32_t n = model.write_frame(slot);
        for (std::uint32_t i = 0; i < n; ++i) CHECK(fields[4][i] > 2);
    }
    CHECK(recycled > 0);
}
