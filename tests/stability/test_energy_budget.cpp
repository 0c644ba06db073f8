// What of the energy of water can become motion.

#include <array>
#include <catch2/catch.hpp>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"
#include "energy_budget.hpp"

using namespace wade;
using namespace wade::stability;

namespace {

// A tank 4 m long and 1 m wide; a column of 1 m x 1 m x 2 m in its corner.
Scene tank() {
    Scene scene;
    scene.world->length = 4;
    scene.world->width = 1;
    scene.channel->x = {0, 4};
    scene.channel->z = {0, 1};
    scene.channel->flow = Flow::closed;
    WaterBlock block;
    block.x = {0, 1};
    block.z = {0, 1};
    block.depth = 2;
    scene.channel->water_blocks = {block};
    scene.fluid->particle_spacing = 0.25;
    scene.fluid->max_particles = 128;
    return scene;
}

double rho_g(const Scene& scene) {
    return scene.fluid->rest_density * scene.world->gravity;
}

}  // namespace

TEST_CASE("a level pool lies on the bed, beside obstacles and over those that it drowns", "[energy_budget]") {
    Scene scene = tank();
    CHECK(level_pool_energy(scene, 2) == Approx(rho_g(scene) * 4 * 0.5 * 0.5 / 2));
    CHECK(level_pool_energy(scene, 0) == Approx(0).margin(1e-9));

    Obstacle block;
    block.x = {1, 2};
    block.z = {0, 1};
    block.height = 1;
    scene.obstacles = {block};
    CHECK(level_pool_energy(scene, 1.5) == Approx(rho_g(scene) * 3 * 0.5 * 0.5 / 2));
    // 1 m on 3 m2, then 0.5 m on 4 m2.
    CHECK(level_pool_energy(scene, 5) == Approx(rho_g(scene) * (3 * 1.0 / 2 + 4 * (1.5 * 1.5 - 1) / 2)));

    scene.obstacles.clear();
    scene.channel->bed_points = {{0, 0}, {4, 2}};
    // A wedge that is 1 m deep and 2 m long: V = 1, centroid at 2/3 m.
    CHECK(level_pool_energy(scene, 1) == Approx(rho_g(scene) * 2.0 / 3).epsilon(0.01));
}

TEST_CASE("of a column only what it loses on its way to a level pool can become motion", "[energy_budget]") {
    const Scene scene = tank();
    fluid::FluidWorld world(scene);
    const EnergyBudget budget(world);
    CHECK(budget.put_in() == Approx(rho_g(scene) * 2.0 * 2 / 2));
    CHECK(budget.convertible() == Approx(rho_g(scene) * (2.0 - 0.5)));
    CHECK(budget.ratio() == Approx(1));
    CHECK(budget.kinetic_ratio() == 0);

    world.set_velocity([](const auto&) { return std::array<double, 3>{3, 0, 0}; });
    const EnergyBudget moving(world);
    const double kinetic = scene.fluid->rest_density * 2 * 9 / 2;
    CHECK(moving.convertible() == Approx(rho_g(scene) * 1.5 + kinetic));
    CHECK(moving.kinetic_ratio() == Approx(kinetic / (rho_g(scene) * 1.5 + kinetic)));
}

TEST_CASE("still water can make waves of half a spacing, no more", "[energy_budget]") {
    Scene scene = tank();
    WaterBlock& block = scene.channel->water_blocks.at(0);
    block.x = {0, 4};
    block.depth = 0.5;
    const EnergyBudget budget{fluid::FluidWorld(scene)};
    CHECK(budget.convertible() == Approx(rho_g(scene) * 4 * 0.25 * 0.25 / 8));
}
