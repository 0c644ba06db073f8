#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "fluid_server/dfsph/fluid_world.hpp"
#include "fluid_server/dfsph/viscosity.hpp"
#include "fluid_server/particles/filling.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;

TEST_CASE("the driving acceleration brings the mean velocity to the bulk speed within the step", "[fluid][forces]") {
    Scene scene;
    scene.channel.x = {0, 8};
    scene.channel.z = {0, 4};
    scene.channel.flow = Flow::recirculating;
    scene.channel.velocity = 1.5;
    scene.channel.initial_river = InitialRiver::filled;
    scene.fluid = test::fluid_of(0.25, 3000);
    FluidWorld world(scene);
    for (int n = 0; n < 20; ++n) {
        world.step(1.0 / 30);
    }
    double mean = 0;
    for (std::size_t i = 0; i < world.particles().count; ++i) {
        mean += static_cast<double>(world.particles().vx[i]) / static_cast<double>(world.particles().count);
    }
    CHECK(mean == Approx(-1.5).margin(1.5e-4));  // rounding of 2,000 single-precision pair forces
}

TEST_CASE("a vertical layer of shear decays at the rate of its viscosity", "[fluid][forces]") {
    // v_x = sin(k z) in a box without gravity: dv/dt = -nu k^2 v.
    Scene scene;
    scene.world.gravity = 0;
    scene.channel.x = {0, 2};
    scene.channel.z = {0, 2};
    scene.channel.flow = Flow::recirculating;
    scene.channel.sides = Sides::periodic;
    scene.channel.depth = 1;
    scene.channel.initial_river = InitialRiver::filled;
    scene.fluid = test::fluid_of(0.1, 5000);
    scene.fluid.kinematic_viscosity = 0.05;
    const auto h = static_cast<float>(2 * scene.fluid.particle_spacing);
    const float dt = 0.01F;
    Particles p(5000);
    CellGrid grid(scene, h);
    const Solids solids(scene);
    NeighbourLists lists(p.capacity());
    ParticleFields fields(p.capacity());
    fill_scene(p, scene);
    grid.sort(p, -Box::inf);
    find_neighbours(grid, solids, p, h, lists);
    const float k = std::numbers::pi_v<float>;
    const auto amplitude = [&] {
        double sum = 0;
        for (std::size_t i = 0; i < p.count; ++i) {
            sum += static_cast<double>(p.vx[i] * std::sin(k * p.z[i])) * 2 / static_cast<double>(p.count);
        }
        return sum;
    };
    for (std::size_t i = 0; i < p.count; ++i) {
        p.vx[i] = std::sin(k * p.z[i]);
    }
    const double before = amplitude();
    for (int n = 0; n < 100; ++n) {
        compute_density_and_diagonal(p, CubicSpline(h), 1e-3F, true, lists, fields);
        apply_viscosity(p, fields, static_cast<float>(scene.fluid.kinematic_viscosity), dt);
    }
    // The free surface has no neighbours above and so no shear there. The lattice sum of the operator is 2 % off in k^2
    // (virial of the cubic spline at two spacings: 1.02), and (k d)^2 / 12 of truncation is 1 %.
    const double rate = -std::log(amplitude() / before) / 1.0;
    CHECK(rate == Approx(0.05 * std::numbers::pi * std::numbers::pi).epsilon(0.05));
}
