#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "configs/scene/world.hpp"
#include "fluid_server/dfsph/dfsph.hpp"
#include "fluid_server/dfsph/fluid_world.hpp"
#include "fluid_server/dfsph/viscosity.hpp"
#include "fluid_server/neighbours/neighbours.hpp"
#include "fluid_server/particles/filling.hpp"
#include "fluid_server/particles/solids.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;

TEST_CASE("the driving acceleration brings the mean velocity to the bulk speed within the step", "[fluid][forces]") {
    Scene scene;
    scene.channel->x = {0, 8};
    scene.channel->z = {0, 4};
    scene.channel->flow = Flow::recirculating;
    scene.channel->velocity = 1.5;
    scene.channel->initial_river = InitialRiver::filled;
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
    scene.world->gravity = 0;
    scene.channel->x = {0, 2};
    scene.channel->z = {0, 2};
    scene.channel->flow = Flow::recirculating;
    scene.channel->sides = Sides::periodic;
    scene.channel->depth = 1;
    scene.channel->initial_river = InitialRiver::filled;
    scene.fluid = test::fluid_of(0.1, 5000);
    scene.fluid->kinematic_viscosity = 0.05;
    const auto h = static_cast<float>(2 * scene.fluid->particle_spacing);
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
        apply_viscosity(p, fields, static_cast<float>(scene.fluid->kinematic_viscosity), dt);
    }
    // The free surface has no neighbours above and so no shear there. The lattice sum of the operator is 2 % off in k^2
    // (virial of the cubic spline at two spacings: 1.02), and (k d)^2 / 12 of truncation is 1 %.
    const double rate = -std::log(amplitude() / before) / 1.0;
    CHECK(rate == Approx(0.05 * std::numbers::pi * std::numbers::pi).epsilon(0.05));
}

// No-slip planes, at rest and moving.
namespace {

constexpr double cube_d = 0.1;
constexpr float viscosity = 1;  // over the second moment of the kernel, m^2/s

// Largest viscous acceleration, m/s2, of a lattice that fills 1 x 1 x 1 m between bed and lid, u_x(y) given.
template <typename Profile>
float largest_acceleration(Scene scene, Profile&& profile) {
    scene.channel->flow = Flow::periodic;
    scene.channel->sides = Sides::periodic;
    scene.channel->top = Top::wall;
    scene.channel->height = 1;
    Particles p(1000);
    for (int n = 0; n < 1000; ++n) {
        const auto at = [](int i) { return (static_cast<float>(i) + 0.5F) * static_cast<float>(cube_d); };
        const float y = at(n / 100);
        p.add({at(n % 10), y, at(n / 10 % 10)}, {profile(y), 0, 0}, Kind::fluid);
    }
    const auto h = static_cast<float>(support_radius_of(scene.fluid));
    CellGrid grid(scene, h);
    grid.sort(p, -Box::inf);
    NeighbourLists lists(p.capacity());
    find_neighbours(grid, Solids(scene), p, h, lists);
    ParticleFields fields(p.capacity());
    compute_density_and_diagonal(p, make_kernel(scene.fluid), static_cast<float>(cube_d * cube_d * cube_d), true, lists,
                                 fields);
    float largest = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        largest = std::max(largest, 2 * viscosity * std::abs(fields.ax[i]));
    }
    return largest;
}

}  // namespace

TEST_CASE("a linear profile between planes that move with it feels no viscous force", "[fluid][no_slip]") {
    Scene scene = test::tank(1, 1, 1, cube_d);
    scene.fluid->kernel = GENERATE(KernelKind::cubic_spline, KernelKind::quartic_spline, KernelKind::wendland_c2);
    scene.channel->no_slip = {{Plane::bed, {0.5, 0, 0}}, {Plane::top, {2.5, 0, 0}}};
    CHECK(largest_acceleration(scene, [](float y) { return 0.5F + 2 * y; }) < 1e-3F);
    // The same profile between planes at rest is held up by both.
    scene.channel->no_slip = {{Plane::bed, {}}, {Plane::top, {}}};
    CHECK(largest_acceleration(scene, [](float y) { return 0.5F + 2 * y; }) > 10);
}

TEST_CASE("free-slip planes let a uniform stream pass", "[fluid][no_slip]") {
    Scene scene = test::tank(1, 1, 1, cube_d);
    CHECK(largest_acceleration(scene, [](float) { return 3.0F; }) < 1e-4F);
    scene.channel->no_slip = {{Plane::bed, {3, 0, 0}}};
    CHECK(largest_acceleration(scene, [](float) { return 3.0F; }) < 1e-4F);
    scene.channel->no_slip = {{Plane::bed, {}}};
    CHECK(largest_acceleration(scene, [](float) { return 3.0F; }) > 10);
}
