#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "configs/scene/channel.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/markers/counter_random.hpp"
#include "crowd_client/navigation/obstacles.hpp"

using namespace wade;
using namespace wade::crowd;

namespace {

Walls block_in_world() {
    Scene scene;
    scene.obstacles.push_back({{40, 50}, {20, 30}, 1});
    return make_walls(scene);
}

constexpr double nowhere = std::numeric_limits<double>::infinity();
constexpr Interval world_ends{0, 100}, over_the_fall{-nowhere, 100};

bool same(const Interval& a, const Interval& b) {
    return a.lo == b.lo && a.hi == b.hi;
}

bool inside(const Obstacle& o, const Vector2d& p) {
    return o.x.lo < p.x() && p.x() < o.x.hi && o.z.lo < p.y() && p.y() < o.z.hi;
}

}  // namespace

TEST_CASE("A free step ends exactly at its target") {
    const Walls walls = block_in_world();
    const Vector2d p(10.1, 10.2);
    const Vector2d d(0.1, -0.3);
    CHECK(slide(walls, p, d, world_ends) == p + d);
}

TEST_CASE("A step into a face slides along it") {
    const Walls walls = block_in_world();
    const Vector2d end = slide(walls, {39, 25}, {5, 2}, world_ends);
    CHECK(end.x() == 40 - Walls::skin);
    // The face takes the component across, the one along it stays; 1e-12 is the rounding of the split of the step.
    CHECK(end.y() == Approx(27).margin(1e-12));
    CHECK(slide(walls, {51, 25}, {-1000, -3}, world_ends).x() == 50 + Walls::skin);
    CHECK(slide(walls, {45, 31}, {1, -500}, world_ends).y() == 30 + Walls::skin);
}

TEST_CASE("A point on a face goes along it and leaves it freely") {
    const Walls walls = block_in_world();
    const Vector2d on_face = slide(walls, {39, 25}, {5, 0}, world_ends);
    CHECK(slide(walls, on_face, {0, 3}, world_ends) == on_face + Vector2d(0, 3));
    CHECK(slide(walls, on_face, {-3, 1}, world_ends) == on_face + Vector2d(-3, 1));
    CHECK(slide(walls, on_face, {3, 0}, world_ends) == on_face);
}

TEST_CASE("A step exactly at a corner does not get through") {
    const Walls walls = block_in_world();
    const Vector2d end = slide(walls, {38, 18}, {14, 14}, world_ends);
    CHECK_FALSE(inside(walls.boxes.all[0], end));
    CHECK((end.x() <= 40 || end.y() <= 20));
}

TEST_CASE("Two boxes that touch have no gap between them") {
    Scene scene;
    scene.obstacles.push_back({{40, 50}, {10, 25}, 1});
    scene.obstacles.push_back({{40, 50}, {25, 40}, 1});
    const Walls walls = make_walls(scene);
    CHECK(slide(walls, {39, 25}, {20, 0}, world_ends) == Vector2d(40 - Walls::skin, 25));
}

TEST_CASE("A step into an inner corner of two boxes stops there") {
    Scene scene;
    scene.obstacles.push_back({{40, 50}, {10, 40}, 1});
    scene.obstacles.push_back({{20, 40}, {30, 40}, 1});
    const Walls walls = make_walls(scene);
    const Vector2d end = slide(walls, {39, 29}, {7, 5}, world_ends);
    CHECK(end == Vector2d(40 - Walls::skin, 30 - Walls::skin));
    CHECK(slide(walls, end, {7, 5}, world_ends) == end);
}

TEST_CASE("No step, however long and wherever it starts, ends in a box or crosses one") {
    Scene scene;
    scene.obstacles.push_back({{40, 50}, {20, 30}, 1});
    scene.obstacles.push_back({{50, 52}, {25, 45}, 1});
    scene.obstacles.push_back({{10, 11}, {0, 50}, 1});  // a wall right across the world
    const Walls walls = make_walls(scene);
    for (std::uint64_t run = 0; run < 200; ++run) {
        Vector2d p(12 + 27 * counter_uniform(1, run, 0), 50 * counter_uniform(1, run, 1));
        for (std::uint64_t i = 1; i <= 100; ++i) {
            // Lengths over eight orders of magnitude.
            const double length = std::pow(10.0, 8 * counter_uniform(2, run, i) - 5);
            const double angle = 6.283185307179586 * counter_uniform(3, run, i);
            p = slide(walls, p, Vector2d(length * std::cos(angle), length * std::sin(angle)), over_the_fall);
            for (const Obstacle& box : scene.obstacles) REQUIRE_FALSE(inside(box, p));
            REQUIRE(p.x() >= 11);  // never through the wall
            REQUIRE(p.x() <= 100);
            REQUIRE(p.y() >= 0);
            REQUIRE(p.y() <= 50);
        }
    }
}

TEST_CASE("Steps end at the same bits whether boxes are found by cells or asked one by one") {
    Scene scene;
    scene.world->length = 120;
    scene.world->width = 40;
    scene.world->ends = GENERATE(Ends::open, Ends::periodic);
    for (std::uint64_t i = 0; i < 150; ++i) {
        // On a lattice of a quarter of a metre, so that many touch and overlap, and steps meet corners; some walls.
        const auto draw = [&](std::uint64_t k, double most) {
            return 0.25 * std::floor(4 * most * counter_uniform(7, i, k));
        };
        const double x = draw(0, 117), z = draw(1, 38), length = i % 20 == 0 ? 12 : 0.25 + draw(2, 2);
        scene.obstacles.push_back({{x, std::min(x + length, 120.0)}, {z, std::min(z + 0.25 + draw(3, 2), 40.0)}, 2});
    }
    const Walls walls = make_walls(scene);
    Walls one_by_one = walls;
    one_by_one.boxes = place_boxes(walls.boxes.all, 1e4);
    REQUIRE(one_by_one.boxes.listed.size() <= 9 * walls.boxes.all.size());

    std::uint64_t bent = 0, left_behind = 0;
    for (std::uint64_t run = 0; run < 500; ++run) {
        const auto on_lattice = [&](double v) { return run % 2 == 0 ? 0.25 * std::floor(4 * v) : v; };
        const Vector2d start(on_lattice(120 * counter_uniform(1, run, 0)), on_lattice(40 * counter_uniform(1, run, 1)));
        const auto place = place_outside(walls, start);
        REQUIRE(place == place_outside(one_by_one, start));
        if (!place) ++left_behind;
        if (!place) continue;
        Vector2d p = *place;
        for (std::uint64_t i = 1; i <= 30; ++i) {
            // From a step at 30 Hz to the displacement of a person in fast water over seconds.
            const double length = 0.04 * std::pow(10.0, 3 * counter_uniform(2, run, i));
            const double angle = std::numbers::pi / 8 * std::floor(16 * counter_uniform(3, run, i));
            const Vector2d step(length * std::cos(angle), length * std::sin(angle));
            const Interval ends = ends_for(walls, p, p.x(), i % 2 == 0);
            const Vector2d to = slide(walls, p, step, ends);
            REQUIRE(to == slide(one_by_one, p, step, ends));
            if (to != p + step) ++bent;
            p = to;
            p.x() = std::clamp(p.x(), 0.0, scene.world->length);
            if (const auto near = place_outside(walls, p); near) p = *near;
        }
    }
    CHECK(bent > 3000);
    CHECK(left_behind > 20);
}

TEST_CASE("The world's edges stop a step, except the fall where that is allowed") {
    const Walls walls = block_in_world();
    CHECK(slide(walls, {1, 1}, {-5, -5}, world_ends) == Vector2d(0, 0));
    CHECK(slide(walls, {1, 1}, {-5, -5}, over_the_fall) == Vector2d(-4, 0));
    CHECK(slide(walls, {99, 49}, {5, 5}, over_the_fall) == Vector2d(100, 50));
}

TEST_CASE("Water carries nobody over x = 0 where the channel is closed, and over the fall elsewhere") {
    Scene scene;
    scene.world = {.length = 30, .width = 10};
    scene.channel->z = {1, 9};
    const auto ends = [&](bool carried_down) { return ends_for(make_walls(scene), {6, 5}, 20, carried_down); };
    for (const Interval& x : {Interval{0, 30}, Interval{5, 25}}) {
        scene.channel->x = x;
        for (const Flow flow : {Flow::emitter, Flow::recirculating, Flow::periodic}) {
            scene.channel->flow = flow;
            CHECK(same(ends(true), Interval{-nowhere, 30}));
            CHECK(same(ends(false), Interval{0, 30}));
        }
        scene.channel->flow = Flow::closed;
        CHECK(same(ends(true), x));
        CHECK(same(ends(false), x));
    }
    scene.world->ends = Ends::periodic;
    CHECK(same(ends(true), Interval{-nowhere, nowhere}));
}

TEST_CASE("The ends of a closed channel keep who is in it and has its goal there, and nobody else") {
    Scene scene;
    scene.world = {.length = 30, .width = 10};
    scene.channel->flow = Flow::closed;
    scene.channel->x = {5, 25};
    scene.channel->z = {1, 9};
    const Walls walls = make_walls(scene);
    for (const bool carried_down : {false, true}) {
        CHECK(same(ends_for(walls, {5, 5}, 20, carried_down), Interval{5, 25}));
        CHECK(same(ends_for(walls, {25, 5}, 25, carried_down), Interval{5, 25}));
        CHECK(same(ends_for(walls, {5, 5}, 2, carried_down), Interval{0, 30}));     // wants to leave
        CHECK(same(ends_for(walls, {4.9, 5}, 20, carried_down), Interval{0, 30}));  // is outside
        CHECK(same(ends_for(walls, {5, 0.5}, 20, carried_down), Interval{0, 30}));  // on the bank
    }
}

TEST_CASE("A walk is shortened at the edge of the world and nowhere else") {
    World world;
    const double dt = 1.0 / 30;
    CHECK(keep_in_world(world, {50, 25}, {1.3, -1.3}, dt) == Vector2d(1.3, -1.3));
    CHECK(keep_in_world(world, {0, 50}, {-1, 1}, dt) == Vector2d(0, 0));
    CHECK(keep_in_world(world, {0.01, 25}, {-1.3, 0.5}, dt).x() == Approx(-0.3).epsilon(1e-14));
    CHECK(keep_in_world(world, {0.01, 25}, {-1.3, 0.5}, dt).y() == 0.5);
}

TEST_CASE("A start on a face is moved to its outside, a start inside a box is refused") {
    const Walls walls = block_in_world();
    CHECK(place_outside(walls, {40, 25}).value() == Vector2d(40 - Walls::skin, 25));
    CHECK(place_outside(walls, {30, 25}).value() == Vector2d(30, 25));
    CHECK_FALSE(place_outside(walls, {45, 25}).has_value());
}
