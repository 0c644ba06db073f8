// Sources and outlets of a site, for particles.

#include <catch2/catch.hpp>
#include <cmath>

#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "fluid_server/particles/site/site_ends.hpp"

namespace wade::fluid::site_ends_test {

// 10 m x 10 m, particles of 0.5 m; a source with 0.5 m3/s, four particles a second, that rises to twice that within 10 s.
Scene site_with(Source source) {
    Scene scene;
    scene.world->length = scene.world->width = 10;
    scene.fluid->particle_spacing = 0.5;
    scene.site.emplace();
    scene.site->ground.level = 3;
    source.discharge = {{0, 0.5}, {10, 1}};
    scene.site->sources = {std::move(source)};
    return scene;
}

Source along(MapLine line) {
    Source source;
    source.name = "along";
    source.line = std::move(line);
    return source;
}

Source over(MapLine ring) {
    Source source;
    source.name = "over";
    source.polygon.rings = {std::move(ring)};
    return source;
}

double nearest_two(const Particles& p) {
    double nearest = INFINITY;
    for (std::size_t i = 0; i < p.count; ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            const double x = double{p.x[i]} - double{p.x[k]}, y = double{p.y[i]} - double{p.y[k]},
                         z = double{p.z[i]} - double{p.z[k]};
            nearest = std::min(nearest, std::sqrt(x * x + y * y + z * z));
        }
    }
    return nearest;
}

}  // namespace wade::fluid::site_ends_test

using namespace wade;
using namespace wade::fluid;
using namespace wade::fluid::site_ends_test;

TEST_CASE("a source makes the integral of its hydrograph, whatever the steps, and none on top of another") {
    for (const Scene& scene : {site_with(along({{0, 2}, {0, 8}})), site_with(along({{2, 2}, {6, 5}})),
                               site_with(over({{4, 4}, {7, 5}, {5, 7}}))}) {
        for (const double dt : {0.013, 0.1, 0.7}) {
            SiteEnds ends(scene);
            Particles particles(1000);
            double time = 0;
            for (; time < 10; time += dt) ends.begin_step(particles, time, dt);
            const double volume = 0.5 * time + 0.5 * 0.05 * std::min(time, 10.0) * std::min(time, 10.0) +
                                  (time > 10 ? 0.5 * (time - 10) : 0);
            CHECK(std::abs(static_cast<double>(particles.count) - std::floor(volume / 0.125)) <= 1);
            CHECK(nearest_two(particles) >= 0.49);
            for (std::size_t i = 0; i < particles.count; ++i) {
                CHECK((particles.x[i] > 0 && particles.x[i] < 10 && particles.z[i] > 0 && particles.z[i] < 10));
                CHECK(particles.y[i] >= 3.24F);
            }
        }
    }
}

TEST_CASE("what a source makes next follows from time and water alone") {
    const Scene scene = site_with(over({{2, 2}, {8, 2}, {8, 8}, {2, 8}}));
    SiteEnds first(scene), later(scene);
    Particles all(1000), half(1000);
    for (int k = 0; k < 100; ++k) first.begin_step(all, 0.1 * k, 0.1);
    SiteEnds begun(scene);
    for (int k = 0; k < 50; ++k) begun.begin_step(half, 0.1 * k, 0.1);
    for (int k = 50; k < 100; ++k) later.begin_step(half, 0.1 * k, 0.1);
    REQUIRE(all.count == half.count);
    CHECK(all.x == half.x);
    CHECK(all.y == half.y);
    CHECK(all.z == half.z);
}

TEST_CASE("a source makes nothing in a house, says what found no room, and is refused without open ground") {
    Scene scene = site_with(along({{0, 5}, {10, 5}}));
    House house;
    house.polygon.rings = {{{2, 3}, {8, 3}, {8, 7}, {2, 7}}};
    scene.site->houses = {house};
    SiteEnds ends(scene);
    Particles particles(10);
    for (int k = 0; k < 40; ++k) ends.begin_step(particles, 0.1 * k, 0.1);
    CHECK(particles.count == 10);
    for (std::size_t i = 0; i < particles.count; ++i) CHECK((particles.x[i] < 2 || particles.x[i] > 8));
    CHECK_THAT(ends.remark(), Catch::Matchers::Contains("no room for 9 particles of the sources"));
    scene.site->sources[0].line = {{3, 5}, {7, 5}};
    CHECK_THROWS_WITH(SiteEnds(scene), Catch::Matchers::Contains("the source \"along\" has no open ground"));
}

TEST_CASE("who comes to a free outlet has left") {
    Scene scene = site_with(over({{2, 2}, {8, 2}, {8, 8}, {2, 8}}));
    scene.site->sources.clear();
    Outlet outlet;
    outlet.line = {{10, 0}, {10, 6}};
    scene.site->outlets = {outlet};
    outlet.line = {};
    outlet.polygon.rings = {{{0, 8}, {2, 8}, {2, 10}, {0, 10}}};
    scene.site->outlets.push_back(outlet);
    SiteEnds ends(scene);
    Particles particles(10);
    for (const auto& [x, z] : {std::pair{9.7F, 3.0F}, {9.3F, 3.0F}, {9.7F, 8.0F}, {1.0F, 9.0F}, {3.0F, 9.0F}})
        particles.add({x, 3.5F, z}, {}, Kind::fluid);
    ends.begin_step(particles, 0, 0.1);
    const std::vector<bool> left{true, false, false, true, false};
    for (std::size_t i = 0; i < particles.count; ++i) CHECK(!(particles.x[i] > ends.outflow_x()) == left[i]);
    CHECK(ends.remark() == "0 m3 came in, 0.25 m3 went out");
}
