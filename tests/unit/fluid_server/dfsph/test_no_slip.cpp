// Planes to which viscous water sticks, moving ones too.

#include <catch2/catch.hpp>
#include <cmath>

#include "configs/scene/scene_capacity.hpp"
#include "fluid_server/dfsph/dfsph.hpp"
#include "fluid_server/neighbours/neighbours.hpp"
#include "fluid_server/particles/solids.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;

namespace {

constexpr double d = 0.1;
constexpr float viscosity = 1;  // over the second moment of the kernel, m^2/s

// Largest viscous acceleration, m/s2, of a lattice that fills 1 x 1 x 1 m between bed and lid, u_x(y) given.
template <typename Profile>
float largest_acceleration(Scene scene, Profile&& profile) {
    scene.channel.flow = Flow::periodic;
    scene.channel.sides = Sides::periodic;
    scene.channel.top = Top::wall;
    scene.channel.height = 1;
    Particles p(1000);
    for (int n = 0; n < 1000; ++n) {
        const auto at = [](int i) { return (static_cast<float>(i) + 0.5F) * static_cast<float>(d); };
        const float y = at(n / 100);
        p.add({at(n % 10), y, at(n / 10 % 10)}, {profile(y), 0, 0}, Kind::fluid);
    }
    const auto h = static_cast<float>(support_radius_of(scene.fluid));
    CellGrid grid(scene, h);
    grid.sort(p, -Box::inf);
    NeighbourLists lists(p.capacity());
    find_neighbours(grid, Solids(scene), p, h, lists);
    ParticleFields fields(p.capacity());
    compute_density_and_diagonal(p, make_kernel(scene.fluid), static_cast<float>(d * d * d), true, lists, fields);
    float largest = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        largest = std::max(largest, 2 * viscosity * std::abs(fields.ax[i]));
    }
    return largest;
}

}  // namespace

TEST_CASE("a linear profile between planes that move with it feels no viscous force", "[fluid][no_slip]") {
    Scene scene = test::tank(1, 1, 1, d);
    scene.fluid.kernel = GENERATE(KernelKind::cubic_spline, KernelKind::quartic_spline, KernelKind::wendland_c2);
    scene.channel.no_slip = {{Plane::bed, {0.5, 0, 0}}, {Plane::top, {2.5, 0, 0}}};
    CHECK(largest_acceleration(scene, [](float y) { return 0.5F + 2 * y; }) < 1e-3F);
    // The same profile between planes at rest is held up by both.
    scene.channel.no_slip = {{Plane::bed, {}}, {Plane::top, {}}};
    CHECK(largest_acceleration(scene, [](float y) { return 0.5F + 2 * y; }) > 10);
}

TEST_CASE("free-slip planes let a uniform stream pass", "[fluid][no_slip]") {
    Scene scene = test::tank(1, 1, 1, d);
    CHECK(largest_acceleration(scene, [](float) { return 3.0F; }) < 1e-4F);
    scene.channel.no_slip = {{Plane::bed, {3, 0, 0}}};
    CHECK(largest_acceleration(scene, [](float) { return 3.0F; }) < 1e-4F);
    scene.channel.no_slip = {{Plane::bed, {}}};
    CHECK(largest_acceleration(scene, [](float) { return 3.0F; }) > 10);
}
