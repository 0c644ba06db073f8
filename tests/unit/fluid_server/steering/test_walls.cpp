#include <catch2/catch.hpp>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/steering.hpp"
#include "flock_pair.hpp"
#include "fluid_server/steering/walls.hpp"

using namespace wade;
using namespace wade::fluid;
using namespace wade::fluid::test;

namespace {

Vec3 at_wall(const steering::Walls& walls, const Vec3& x, const Vec3& v = {0, 0, 0}) {
    Vec3 a{};
    walls.add_acceleration(x, v, a);
    return a;
}

void check_deflected(const Vec3& a, double x, double y, double z) {
    CHECK(static_cast<double>(a[0]) == Approx(x).epsilon(1e-4).margin(1e-6));
    CHECK(static_cast<double>(a[1]) == Approx(y).epsilon(1e-4).margin(1e-6));
    CHECK(static_cast<double>(a[2]) == Approx(z).epsilon(1e-4).margin(1e-6));
}

}  // namespace

TEST_CASE("planes and boxes push with weight ((radius / distance)^2 - 1) along their normal", "[steering]") {
    Scene scene = tank(10, 8, 2, 0.5);
    scene.obstacles = {{{4, 6}, {3, 5}, 1}};
    const Solids solids(scene);
    steering::Settings s = quiet_settings();
    s.wall = 3;
    const steering::Walls walls(solids, scene.channel, s);
    const double push = 3 * (0.25 / 0.16 - 1);
    check_deflected(at_wall(walls, {1, 0.4F, 1}), 0, push, 0);  // bed
    check_deflected(at_wall(walls, {0.4F, 1, 1}), push, 0, 0);  // ends
    check_deflected(at_wall(walls, {9.6F, 1, 1}), -push, 0, 0);
    check_deflected(at_wall(walls, {1, 1, 7.6F}), 0, 0, -push);                          // bank
    check_deflected(at_wall(walls, {0.4F, 0.4F, 1}), push, push, 0);                     // edge
    check_deflected(at_wall(walls, {3.6F, 0.7F, 4}), -push, 0, 0);                       // box: side
    check_deflected(at_wall(walls, {5, 1.4F, 4}), 0, push, 0);                           // top
    check_deflected(at_wall(walls, {3.76F, 0.7F, 2.68F}), -0.6 * push, 0, -0.8 * push);  // edge
    check_deflected(at_wall(walls, {2, 1, 2}), 0, 0, 0);
}

TEST_CASE("walls take speed, most at the face", "[steering]") {
    const Scene scene = tank(10, 8, 2, 0.5);
    steering::Settings s = quiet_settings();
    s.wall_loss = 2;
    const steering::Walls walls(Solids(scene), scene.channel, s);
    check_deflected(at_wall(walls, {5, 0.1F, 4}, {1, -2, 3}), -2 * 0.8 * 1, 2 * 0.8 * 2, -2 * 0.8 * 3);
    check_deflected(at_wall(walls, {5, 0.6F, 4}, {1, -2, 3}), 0, 0, 0);
}

TEST_CASE("the bed's facets push along their normal", "[steering]") {
    Scene scene = tank(10, 8, 2, 0.5);
    scene.channel->bed_points = {{0, 0}, {10, 7.5}};
    steering::Settings s = quiet_settings();
    s.wall = 1;
    const steering::Walls walls(Solids(scene), scene.channel, s);
    const double push = 0.25 / 0.04 - 1;
    // 0.2 m above the slope of 3 : 4 at x = 4.
    check_deflected(at_wall(walls, {4 - 0.12F, 3 + 0.16F, 4}), -0.6 * push, 0.8 * push, 0);
}

TEST_CASE("as a constraint walls let nobody through; as a force alone they hold water at rest", "[steering]") {
    for (const SteeringWalls rule : {SteeringWalls::constraint, SteeringWalls::force}) {
        Scene scene = steering_tank(0.6, 0.6, 0.5, 0.1);
        scene.fluid->steering.walls = rule;
        steering::SteeringWorld world(scene);
        for (int k = 0; k < 30; ++k) world.step(1.0 / 30);
        const double nearest = rule == SteeringWalls::constraint ? 0.04 - 1e-5 : 0.0;
        for (std::size_t i = 0; i < world.particles().count; ++i) {
            const Vec3 x = world.place(i);
            CHECK(static_cast<double>(x[1]) >= nearest);
            CHECK(static_cast<double>(x[0]) >= nearest);
            CHECK(static_cast<double>(x[0]) <= 0.6 - nearest);
        }
        CHECK(world.position_clamps() == 0);
    }
}
