// Walls of a site, contact with them, and water at t = 0 between them.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

#include "fluid_server/particles/site/site_filling.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;

namespace wade::fluid::site_test {

using test::house_of;
using test::SiteTank;

// An empty world of 10 x 10 m with these houses and gates.
SiteShape shape_of(std::vector<MapLine> houses, std::vector<Barrier> gates = {}) {
    Scene scene = test::site_scene({.side = 10}, 0, 0.1);
    scene.site->houses.clear();
    for (MapLine& ring : houses) scene.site->houses.push_back(house_of({std::move(ring)}));
    scene.site->barriers = std::move(gates);
    return site_shape(scene);
}

struct Count {
    std::size_t walls = 0, edges = 0, loose = 0;
    bool operator==(const Count&) const = default;
};
Count count(const std::vector<Wall>& walls) {
    Count n;
    for (const Wall& wall : walls) {
        ++n.walls;
        n.edges += wall.edge_after ? 1U : 0U;
        n.loose += wall.after == Wall::none ? 1U : 0U;
    }
    return n;
}

TEST_CASE("a site's walls are the outlines of what is not water", "[site]") {
    const MapLine box{{4, 4}, {6, 4}, {6, 6}, {4, 6}};
    CHECK(count(walls_of(shape_of({}), 0, 0)) == Count{4, 0, 0});
    CHECK(count(walls_of(shape_of({box}), 0, 0)) == Count{8, 4, 0});
    // An L has one inner corner, clockwise and counter-clockwise.
    MapLine l{{4, 4}, {6, 4}, {6, 5}, {5, 5}, {5, 6}, {4, 6}};
    CHECK(count(walls_of(shape_of({l}), 0, 0)) == Count{10, 5, 0});
    std::reverse(l.begin(), l.end());
    CHECK(count(walls_of(shape_of({l}), 0, 0)) == Count{10, 5, 0});
    // Houses in a row are one; a second time the same house changes nothing.
    CHECK(count(walls_of(shape_of({box, {{6, 4}, {8, 4}, {8, 6}, {6, 6}}}), 0, 0)) == Count{8, 4, 0});
    CHECK(count(walls_of(shape_of({box, box}), 0, 0)) == Count{8, 4, 0});
    // Two that overlap as a cross: 12 walls, 8 edges.
    CHECK(count(walls_of(shape_of({{{4, 2}, {6, 2}, {6, 8}, {4, 8}}, {{2, 4}, {8, 4}, {8, 6}, {2, 6}}}), 0, 0)) ==
          Count{16, 8, 0});
    // At the world's side a house has two inner corners and cuts the side in two.
    CHECK(count(walls_of(shape_of({{{4, -1}, {6, -1}, {6, 2}, {4, 2}}}), 0, 0)) == Count{8, 2, 0});
    // Two that touch at a corner make two inner ones.
    CHECK(count(walls_of(shape_of({box, {{6, 6}, {8, 6}, {8, 8}, {6, 8}}}), 0, 0)) == Count{12, 6, 0});
}

TEST_CASE("a gate is a wall on both sides until it opens", "[site]") {
    Barrier gate;
    gate.line = {{5, 0}, {5, 10}};
    gate.opens_at = 2;
    const SiteShape shape = shape_of({}, {gate});
    CHECK(count(walls_of(shape, 0, 0)) == Count{8, 0, 0});
    CHECK(count(walls_of(shape, 2, 0)) == Count{4, 0, 0});
    gate.line = {{5, 2}, {5, 8}};  // water goes round its ends
    CHECK(count(walls_of(shape_of({}, {gate}), 0, 0)) == Count{6, 2, 0});
}

TEST_CASE("walls have the water on the side of their normals", "[site]") {
    SiteTank tank{.turned = 17, .corner = 70, .side = 10};
    const SiteSolids solids = test::solids_of(test::site_scene(tank, 0, 0.1));
    REQUIRE(solids.walls().size() == 4);
    for (const Wall& wall : solids.walls()) {
        const PlanPoint middle = wall.at(0.5F * wall.length);
        const float step = 0.01F;
        CHECK(solids.is_water({middle.x + step * wall.nx, 0, middle.z + step * wall.nz}));
        CHECK_FALSE(solids.is_water({middle.x - step * wall.nx, 0, middle.z - step * wall.nz}));
    }
}

TEST_CASE("contact stops what would come too near to an oblique wall, and no more", "[site]") {
    const SiteTank tank{.turned = 30};
    const SiteSolids solids = test::solids_of(test::site_scene(tank, 0, 0.1));
    constexpr float dt = 0.1F, distance = 0.04F;
    const Wall& wall = solids.walls()[0];
    const PlanPoint middle = wall.at(0.5F * wall.length);
    const float x = middle.x + 0.1F * wall.nx, y = 1, z = middle.z + 0.1F * wall.nz;
    BlockVelocities v{};
    v.x[0] = 0.5F * wall.ux - 2 * wall.nx, v.y[0] = 0, v.z[0] = 0.5F * wall.uz - 2 * wall.nz;
    solids.apply_contact({&x, &y, &z}, 1, dt, v);
    CHECK(wall.ux * v.x[0] + wall.uz * v.z[0] == Approx(0.5).margin(1e-5));
    CHECK(wall.nx * v.x[0] + wall.nz * v.z[0] == Approx(-(0.1F - distance) / dt).margin(1e-4));
    v.x[0] = wall.nx, v.z[0] = wall.nz;
    solids.apply_contact({&x, &y, &z}, 1, dt, v);
    CHECK(v.x[0] == wall.nx);
    CHECK(v.z[0] == wall.nz);
}

TEST_CASE("nothing gets through walls, corners or the ground of a site", "[site]") {
    const SiteTank tank{.turned = 17, .corner = 60};
    Scene scene = test::site_scene(tank, 0, 0.1);
    scene.site->houses.push_back(house_of({{tank.at(-0.2, -0.2), tank.at(0.2, -0.2), tank.at(0.2, 0), tank.at(0, 0),
                                            tank.at(0, 0.2), tank.at(-0.2, 0.2)}}));
    scene.site->ground.slope_x = 0.3;
    const SiteSolids solids = test::solids_of(scene);
    constexpr float dt = 0.01F;
    constexpr std::size_t n = 256;
    std::vector<float> x, y, z;
    BlockVelocities v{};
    for (std::size_t i = 0; i < n; ++i) {
        const double a = 0.39 * static_cast<double>(i);
        const MapPoint p = tank.at(0.4 * std::cos(a), 0.4 * std::sin(a));
        x.push_back(static_cast<float>(p.x)), z.push_back(static_cast<float>(p.z));
        y.push_back(solids.ground().at(x[i], z[i]).height(x[i], z[i]) + 0.3F);
    }
    for (int step = 0; step < 200; ++step) {
        for (std::size_t i = 0; i < n; ++i) {
            const double a = 1.7 * static_cast<double>(i) + 0.02 * step;  // 4 m/s, 0.4 spacings a step
            v.x[i] = static_cast<float>(3.9 * std::cos(a)), v.y[i] = -1, v.z[i] = static_cast<float>(3.9 * std::sin(a));
        }
        solids.apply_contact({x.data(), y.data(), z.data()}, n, dt, v);
        for (std::size_t i = 0; i < n; ++i) x[i] += dt * v.x[i], y[i] += dt * v.y[i], z[i] += dt * v.z[i];
    }
    std::size_t outside = 0;
    for (std::size_t i = 0; i < n; ++i) {
        outside += solids.is_water({x[i], y[i], z[i]}) ? 0U : 1U;
        CHECK(solids.ground().at(x[i], z[i]).distance({x[i], y[i], z[i]}) > 0.039F);
    }
    CHECK(outside == 0);
}

TEST_CASE("water of a site is as much as its volume, whatever the angle", "[site]") {
    const double angle = GENERATE(0, 17, 30, 45);
    const SiteTank tank{.turned = angle};
    const Scene scene = test::site_scene(tank, 0.53, 0.1);
    const SiteSolids solids = test::solids_of(scene);
    Particles particles(2000);
    fill_site(particles, scene, solids);
    CHECK(static_cast<double>(particles.count) == Approx(1.2 * 1.2 * 0.53 / 1e-3).epsilon(5e-3));
    for (std::size_t i = 0; i < particles.count; ++i) {
        CHECK(solids.is_water({particles.x[i], particles.y[i], particles.z[i]}));
        CHECK(particles.y[i] < 0.7F);
    }
}

TEST_CASE("the ground of a site is straight within its triangles", "[site]") {
    Scene scene = test::site_scene({}, 0, 0.1);
    const auto height = [](double x, double z) { return 0.2 * std::sin(2 * x) * std::cos(1.5 * z); };
    const auto raster = std::make_shared<Raster>();
    raster->cell = 0.1, raster->columns = raster->rows = 40;
    for (int k = 0; k < 40; ++k) {
        for (int i = 0; i < 40; ++i) raster->values.push_back(height((i + 0.5) * 0.1, (k + 0.5) * 0.1));
    }
    scene.site->ground.raster = raster;
    const SiteShape shape = site_shape(scene);
    const GroundFacets facets(shape.ground);
    CHECK_FALSE(shape.ground.is_plane);
    double worst = 0;
    for (double x = 0.21; x < 3.8; x += 0.17) {
        for (double z = 0.21; z < 3.8; z += 0.17) {
            const auto fx = static_cast<float>(x), fz = static_cast<float>(z);
            const auto of_facets = static_cast<double>(facets.at(fx, fz).height(fx, fz));
            CHECK(of_facets == Approx(shape.ground.height_at({x, z})).margin(2e-5));
            worst = std::max(worst, std::abs(of_facets - height(x, z)));
        }
    }
    // Cells of 0.3 m over curvatures of 0.8 and 0.45 / m: chords are off by (0.8 + 0.45) x 0.3^2 / 8 = 0.014 m, and the means of the
    // nodes by 2/3 of that.
    CHECK(worst < 0.024);
    scene.site->ground = {};
    scene.site->ground.slope_x = 0.1;
    CHECK(GroundFacets(site_shape(scene).ground).is_one_plane());
}

}  // namespace wade::fluid::site_test
