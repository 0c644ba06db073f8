#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "configs/scene/crowd.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/markers/biocrowds.hpp"

using namespace wade;
using namespace wade::crowd;

namespace {

// Markers by hand, sorted into cells.
Markers markers_at(const World& world, const std::vector<Vector2d>& points) {
    Markers markers;
    markers.grid = GroundGrid::over(world);
    markers.cell_start.push_back(0);
    for (std::size_t c = 0; c < markers.grid.cells(); ++c) {
        for (const Vector2d& p : points) {
            if (markers.grid.cell_of(p.x(), p.y()) != c) continue;
            markers.x.push_back(p.x());
            markers.z.push_back(p.y());
        }
        markers.cell_start.push_back(static_cast<std::uint32_t>(markers.x.size()));
    }
    return markers;
}

World world_of(double length, double width) {
    World world;
    world.length = length;
    world.width = width;
    return world;
}

// Returns the motion that the markers give to walkers; all of them want to go towards +x.
Motion motion_of(const Markers& markers, const std::vector<Vector2d>& walkers, double radius = 1.0, int threads = 1) {
    Motion motion;
    const std::vector<Vector2d> goal_offsets(walkers.size(), Vector2d(10, 0));
    Walkers w;
    w.position = walkers;
    w.goal_offset = goal_offsets;
    MarkerMemory memory;
    find_motion(motion, memory, markers, w, radius, 0, threads);
    return motion;
}

}  // namespace

TEST_CASE("A marker belongs to the nearest walker within the radius of perception") {
    const Markers markers = markers_at(world_of(10, 10), {{5, 5}});
    const Motion motion = motion_of(markers, {{5.6, 5}, {5, 4.5}, {4.2, 5}});
    CHECK(motion.owned == std::vector<std::uint32_t>{0, 1, 0});
    CHECK(motion.vector[1] == Vector2d(0, 0.5));  // the only marker has all the weight
}

TEST_CASE("A marker at the same distance of two walkers belongs to the first") {
    const Markers markers = markers_at(world_of(10, 10), {{4, 4}});  // a corner of four cells
    const std::vector<Vector2d> walkers{{4.5, 4}, {4, 3.5}, {3.5, 4}, {4, 4.5}};
    const std::vector<std::uint32_t> first{1, 0, 0, 0};
    CHECK(motion_of(markers, walkers).owned == first);
    CHECK(motion_of(markers, {walkers[3], walkers[2], walkers[1], walkers[0]}).owned == first);
}

TEST_CASE("A marker beyond the radius of perception belongs to nobody") {
    const Markers markers = markers_at(world_of(10, 10), {{5, 5}, {6.5, 5}});
    CHECK(motion_of(markers, {{5.75, 6}}).owned[0] == 0);
    CHECK(motion_of(markers, {{4, 5}}).owned[0] == 1);  // exactly at the radius
}

TEST_CASE("Claims by cells are those of a search over all pairs") {
    Scene scene;
    scene.world = world_of(30, 20);
    const double radius = GENERATE(0.4, 1.0, 1.7);
    const Markers markers = place_markers(scene);
    std::vector<Vector2d> walkers;
    for (int i = 0; i < 80; ++i) {  // a low-discrepancy set, edges of the world included
        walkers.emplace_back(std::fmod(i * 30 * 0.6180339887, 30.0),
                             i % 8 == 0 ? 20.0 : std::fmod(i * 20 * 0.7548776662, 20.0));
    }
    std::vector<std::uint32_t> count(walkers.size(), 0);
    for (std::size_t m = 0; m < markers.size(); ++m) {
        std::size_t owner = walkers.size();
        double best = radius;
        for (std::size_t k = 0; k < walkers.size(); ++k) {
            const double distance = (Vector2d(markers.x[m], markers.z[m]) - walkers[k]).norm();
            if (distance < best) {
                best = distance;
                owner = k;
            }
        }
        if (owner < walkers.size()) ++count[owner];
    }
    CHECK(motion_of(markers, walkers, radius).owned == count);
    CHECK(motion_of(markers, walkers, radius, 3).owned == count);
}

TEST_CASE("A walker without markers stands still") {
    const Markers markers = markers_at(world_of(10, 10), {});
    CHECK(motion_of(markers, {{5, 5}}).vector[0] == Vector2d(0, 0));
}

TEST_CASE("A walker whose markers all lie behind it stands still") {
    const Markers markers = markers_at(world_of(10, 10), {{4.5, 5}});
    const Motion motion = motion_of(markers, {{5, 5}});
    REQUIRE(motion.owned[0] == 1);
    CHECK(motion.vector[0] == Vector2d(0, 0));
}

TEST_CASE("The weighted mean of two markers by hand") {
    // Goal ahead (+x). Marker A 0.5 m ahead: f = 2/1.5; marker B 0.5 m abreast (+z): f = 1/1.5; weights 2/3 and 1/3;
    // m = (1/3, 1/6), |m| = sqrt(5)/6 = 0.3727 m, pi |m| > 1, so the speed is the desired one.
    const Markers markers = markers_at(world_of(10, 10), {{5.5, 5}, {5, 5.5}});
    const Vector2d m = motion_of(markers, {{5, 5}}).vector[0];
    const Vector2d v = walking_velocity(m, 1.3, SpeedRule::pi, 1.0 / 30);
    CHECK(v.x() == Approx(1.3 * 2 / std::sqrt(5.0)).epsilon(1e-14));
    CHECK(v.y() == Approx(1.3 * 1 / std::sqrt(5.0)).epsilon(1e-14));
}

TEST_CASE("The motion vector in free space is 0.3147 m long in the mean") {
    // In a full disc of radius 1 the integral of Eq. 1-3 over a uniform density has the closed form
    // m = [int r^2/(1+r) dr / int r/(1+r) dr] / 2 = (ln 2 - 1/2) / (2 (1 - ln 2)) = 0.31472.
    Scene scene;
    scene.world = world_of(60, 40);
    const Markers markers = place_markers(scene);
    Vector2d sum = Vector2d::Zero();
    int n = 0;
    for (double x = 1.5; x < 59; x += 3) {
        for (double z = 1.5; z < 39; z += 3, ++n) {
            sum += motion_of(markers, {{x, z}}).vector[0];
        }
    }
    const double expected = (std::log(2.0) - 0.5) / (2 * (1 - std::log(2.0)));
    // About 50 markers a walker, each contributing a scatter of about 0.35 m: 0.05 m for one, 0.0031 m for the mean of
    // 260 of them; four of these.
    CHECK(n == 260);
    CHECK(sum.x() / n == Approx(expected).margin(0.0125));
    CHECK(sum.y() / n == Approx(0).margin(0.0125));
}
