// The rule `continuous` with the water sampled within a step.

#include <catch2/catch.hpp>

#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/responses/sampled_coupling.hpp"
#include "crowd_client/water/contacts.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::one_agent_scene;

namespace {

Scene sampled_scene(double step_rate, double sampling_rate, double transport = 1) {
    Scene scene = one_agent_scene(50, 25, 50, 50, 0.5);
    scene.frame_rate = scene.crowd->step_rate = step_rate;
    scene.coupling->rule = CouplingRule::continuous;
    scene.coupling->sampling_rate = sampling_rate;
    scene.fluid->model = ModelKind::kinematic;
    scene.fluid->kinematic.transport_factor = transport;
    return scene;
}

// Two rows of particles, at distances that do not divide one another, moved on for a time.
MadeUpWater rows_at(double time, double transport) {
    MadeUpWater water;
    for (int i = 0; i < 200; ++i) {
        const double x = 40 + 0.37 * i - transport * 1.5 * time;
        water.add(x, 25.05, 60, -1.5, 0);
        water.add(x + 0.1, 24.8, 80, -1.5, 0);
    }
    return water;
}

WaterBins bins_of(const Scene& scene, const MadeUpWater& water) {
    WaterBins bins = empty_bins(scene);
    bin_all_water(bins, water.view());
    return bins;
}

}  // namespace

TEST_CASE("The samples in a step are its length times the rate, rounded up") {
    CHECK(sampling_of(sampled_scene(15, 120)).samples == 8);
    CHECK(sampling_of(sampled_scene(30, 100)).samples == 4);
    CHECK(sampling_of(sampled_scene(30, 0)).samples == 1);
    CHECK(sampling_of(sampled_scene(120, 120)).samples == 1);
    CHECK(sampling_of(sampled_scene(15, 120, 2.6)).transport == 2.6);
    Scene solved = sampled_scene(15, 120, 2.6);
    solved.fluid->model = ModelKind::dfsph;
    CHECK(sampling_of(solved).transport == 1);
}

TEST_CASE("A step with samples is as many short steps through water that moves", "[eq9]") {
    for (const double transport : {1.0, 2.6}) {
        const Scene scene = sampled_scene(15, 120, transport);
        Walker walker{{50, 25}, {0.1, 0.4}, {0, 1.25}, 65, 0.5};
        const RelaxedVelocity whole =
            sampled_velocity(bins_of(scene, rows_at(0, transport)), scene, sampling_of(scene), walker, 1.0 / 15);
        Vector2d way = Vector2d::Zero();
        std::vector<WaterParticle> touching;
        double met = 0;
        for (int i = 0; i < 8; ++i) {
            const WaterBins bins = bins_of(scene, rows_at(i / 120.0, transport));
            const Contact contact = find_contact(bins, walker.position, contact_distance(scene.coupling), touching);
            met += contact.mass;
            const RelaxedVelocity part =
                relaxed_velocity(walker.mass, walker.velocity, walker.walking, walker.tau, contact, 1.0 / 120);
            walker.velocity = part.at_end;
            walker.position += part.mean / 120;
            way += part.mean / 120;
        }
        REQUIRE(met > 0);
        // Positions of particles are floats, to 4e-6 m there; no particle is that near to the edge of the contact.
        CHECK(whole.mean.x() == Approx(way.x() * 15).margin(1e-9));
        CHECK(whole.mean.y() == Approx(way.y() * 15).margin(1e-9));
        CHECK(whole.at_end.x() == Approx(walker.velocity.x()).margin(1e-9));
    }
}

TEST_CASE("Without samples the contact is that of the frame") {
    const Scene scene = sampled_scene(30, 0);
    const WaterBins bins = bins_of(scene, rows_at(0, 1));
    std::vector<WaterParticle> touching;
    const Contact frame = find_contact(bins, {50, 25}, 0.25, touching);
    const Contact now = contact_after(bins, scene.world, {50, 25}, 0.25, 0, 1);
    CHECK(now.mass == frame.mass);
    CHECK(now.momentum.x() == Approx(frame.momentum.x()));
}

TEST_CASE("A sampled agent that the water carries over the fall is dead") {
    Scene scene = sampled_scene(15, 120);
    scene.crowd->groups[0].start_x = 0.05;
    scene.crowd->groups[0].tau = {1, 1};
    CrowdWorld crowd = make_crowd(scene);
    const MadeUpWater water = testing::uniform_water(0, 4, 15, 35, 1, 0.25, -2.5, 0);
    for (int i = 0; i < 15 && crowd.dead == 0; ++i) step(crowd, water.view());
    CHECK(crowd.dead == 1);
}
