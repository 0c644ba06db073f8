#include <catch2/catch.hpp>

#include "configs/scene/channel.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/water/water_met.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::one_agent_scene;
using wade::crowd::testing::uniform_water;

namespace {

// An agent walks to z = 50 and does not drift, by tau = 0; the channel lies from z = 11.5 to 38.5.
CrowdWorld walker_from(double z) {
    Scene scene = one_agent_scene(50, z, 50, 50, 0);
    scene.channel->x = {0, 100};
    scene.channel->z = {11.5, 38.5};
    return make_crowd(scene);
}

MadeUpWater stream(double depth, double speed) {
    return uniform_water(40, 60, 11.5, 38.5, depth, 0.25, -speed, 0);
}

}  // namespace

TEST_CASE("The share of a cell in the channel is less at a bank and none beside it") {
    Channel channel;
    channel.x = {0, 99};
    channel.z = {11.5, 38.5};
    CHECK(channel_share(channel, {50.5, 25}) == 1);
    CHECK(channel_share(channel, {50.5, 11.6}) == 0.25);
    CHECK(channel_share(channel, {50.5, 11.4}) == 0);
    CHECK(channel_share(channel, {98.5, 38.4}) == 0.125);
    CHECK(channel_share(channel, {99.5, 25}) == 0);
}

TEST_CASE("The mean depth met is that of the stream, also in cells that a bank cuts") {
    CrowdWorld crowd = walker_from(11.6);
    const MadeUpWater water = stream(1, 1.5);
    for (int i = 0; i < 60; ++i) step(crowd, water.view());
    REQUIRE(crowd.agents.position[0].y() > 12.5);  // from a cell with a bank into one without
    CHECK(mean_depth_met(crowd.agents, 0) == Approx(1));
    CHECK(mean_dv_met(crowd.agents, 0) == Approx(1.5));
}

TEST_CASE("The means are over the time in the water, the largest values over all of it") {
    CrowdWorld crowd = walker_from(20);
    for (int i = 0; i < 10; ++i) step(crowd, MadeUpWater{}.view());
    CHECK(mean_depth_met(crowd.agents, 0) == 0);
    for (int i = 0; i < 10; ++i) step(crowd, stream(0.5, 1).view());
    for (int i = 0; i < 30; ++i) step(crowd, stream(1, 2).view());
    CHECK(crowd.agents.wet_steps[0] == 40);
    CHECK(mean_depth_met(crowd.agents, 0) == Approx((10 * 0.5 + 30 * 1) / 40));
    CHECK(mean_dv_met(crowd.agents, 0) == Approx((10 * 0.5 + 30 * 2.0) / 40));
    CHECK(mean_tau_met(crowd.agents, 0) == 0);
    CHECK(crowd.agents.max_depth[0] == Approx(1));
    CHECK(crowd.agents.max_dv[0] == Approx(2));
}

TEST_CASE("Water beside the channel is not met") {
    CrowdWorld crowd = walker_from(10.5);  // its cell holds the edge of the stream
    step(crowd, stream(1, 1.5).view());
    CHECK(crowd.agents.wet_steps[0] == 0);
    CHECK(crowd.agents.max_depth[0] > 0);
}
