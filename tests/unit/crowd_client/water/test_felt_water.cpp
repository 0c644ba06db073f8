#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/markers/counter_random.hpp"
#include "crowd_client/people/person.hpp"
#include "crowd_client/water/felt_water.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::one_agent_scene;
using wade::crowd::testing::uniform_water;

namespace {

// A channel from z = 11.5 to 38.5 m with boxes, and particles d apart.
Scene river(double d, std::vector<Obstacle> boxes = {}) {
    Scene scene = one_agent_scene(50, 25, 50, 50, 0);
    scene.fluid->particle_spacing = d;
    scene.obstacles = std::move(boxes);
    return scene;
}

// A metre deep, 1.5 m/s along -x, but none where boxes stand.
MadeUpWater stream(const Scene& scene, double x_lo = 40, double x_hi = 60) {
    const MadeUpWater all = uniform_water(x_lo, x_hi, 11.5, 38.5, 1, scene.fluid->particle_spacing, -1.5, 0);
    MadeUpWater rest;
    for (std::size_t i = 0; i < all.mass.size(); ++i) {
        const double x = static_cast<double>(all.px[i]), z = static_cast<double>(all.pz[i]);
        bool solid = false;
        for (const Obstacle& box : scene.obstacles) solid = solid || (box.x.contains(x) && box.z.contains(z));
        if (!solid) rest.add(x, z, static_cast<double>(all.mass[i]), -1.5, 0);
    }
    return rest;
}

FeltWater felt_at(const Scene& scene, const MadeUpWater& water, const Vector2d& place) {
    WaterBins bins = empty_bins(scene);
    bin_water(bins, water.view(), {&place, 1});
    return feel_water(make_feeling(scene), bins, place);
}

// The integral of the cone by counting squares of R / 500.
double counted_ground(const Scene& scene, const Vector2d& place, double spread) {
    constexpr int half = 500;
    double sum = 0;
    for (int j = -half; j < half; ++j) {
        for (int i = -half; i < half; ++i) {
            const Vector2d at = place + spread / half * Vector2d(i + 0.5, j + 0.5);
            bool open = scene.channel->x.contains(at.x()) && scene.channel->z.contains(at.y());
            for (const Obstacle& box : scene.obstacles)
                open = open && !(box.x.contains(at.x()) && box.z.contains(at.y()));
            if (open) sum += std::max(0.0, 1 - (at - place).norm() / spread);
        }
    }
    return sum * spread * spread / (half * half);
}

// Returns the mean sampled depth at a position; particles lie anywhere in their cells of the lattice around it.
double mean_depth(const Scene& scene, const Vector2d& place) {
    const double d = scene.fluid->particle_spacing, reach = 1.6;
    auto any = [n = std::uint64_t{0}]() mutable { return counter_uniform(1, 1, n++); };
    const int waters =
        std::max(200, static_cast<int>(40000 * d * d));  // the mean depth then is known to 1 % in corners
    double sum = 0;
    for (int n = 0; n < waters; ++n) {
        MadeUpWater water;
        const double x0 = d * std::floor((place.x() - reach) / d);
        for (double z = std::max(11.5, 11.5 + d * std::floor((place.y() - 11.5 - reach) / d)); z < place.y() + reach;
             z += d) {
            for (double x = x0; x < place.x() + reach; x += d) {
                const Vector2d at(x + d * any(), z + d * any());
                bool solid = false;
                for (const Obstacle& box : scene.obstacles) {
                    solid = solid || (box.x.contains(at.x()) && box.z.contains(at.y()));
                }
                if (!solid) water.add(at.x(), at.y(), 1000 * d * d, -1.5, 0);
            }
        }
        sum += felt_at(scene, water, place).depth / waters;
    }
    return sum;
}

// Columns c m wide over the width of the channel, 0.8 m deep.
MadeUpWater columns(double c) {
    MadeUpWater water;
    for (double x = 30 + 0.5 * c; x < 70; x += c) {
        for (double z = 11.5 + 0.5 * c; z < 38.5; z += c) water.add(x, z, 1000 * 0.8 * c * c, -1.2, 0.3);
    }
    return water;
}

FeltWater felt_of_columns(const Scene& scene, double c, const Vector2d& place) {
    WaterBins bins = empty_bins(scene);
    const MadeUpWater water = columns(c);
    WaterView view = water.view();
    view.column = {c, c};
    bin_water(bins, view, {&place, 1});
    return feel_water(make_feeling(scene, view.column), bins, place);
}

const std::vector<Obstacle> two_obstacles{{{45, 50}, {20, 24}, 3}, {{50, 51}, {20, 22}, 3}};  // one wall of both

}  // namespace

TEST_CASE("In an even stream people feel its depth and velocity") {
    const Scene scene = river(0.25);
    const FeltWater felt = felt_at(scene, stream(scene), {50.1, 25.06});
    CHECK(felt.depth == Approx(1).epsilon(0.03));  // 12 particles in the disc of each layer
    CHECK(felt.velocity.x() == Approx(-1.5));
    CHECK(felt.velocity.y() == 0);
    CHECK(felt.spread == 0.5);
    CHECK(felt.weight == Approx(1000 * std::numbers::pi * 0.25 / 3).epsilon(0.03));
    CHECK(felt.theta == Approx(0.5).epsilon(0.05));
}

TEST_CASE("The cone is 1.5 spacings wide and half a metre at least; wider than the sorted water is refused") {
    CHECK(make_feeling(river(0.1)).spread == 0.5);
    CHECK(make_feeling(river(0.4642)).spread == Approx(0.6963));
    CHECK(make_feeling(river(4.0 / 3)).spread == Approx(2));
    CHECK_THROWS_WITH(make_feeling(river(1.4)),
                      Catch::Contains("/fluid/particle_spacing_m") && Catch::Contains("1.33"));
}

TEST_CASE("At walls, in corners and beside houses people feel the depth of mid-stream, and the same demands") {
    const double d = GENERATE(0.125, 0.25, 0.4642);
    const Scene scene = river(d, two_obstacles);
    const Body body;
    // Of the mean depth, as people fail on means: a single lattice of 1.5 spacings in the cone is off by some per cent.
    const auto demands = [&](const Vector2d& place) {
        const double depth = mean_depth(scene, place), k = drag_upright(body.height, depth, {});
        const double weight = weight_on_feet(body, depth, {});
        return std::array{depth, slip_demand(k, {1.5, 0}, {0, 0}, 0.45, weight),
                          topple_demand(k, {1.5, 0}, depth, weight, 0.09 * body.height)};
    };
    const auto middle = demands({55, 30});
    for (const Vector2d& place : {Vector2d(55, 11.5), Vector2d(55, 11.7), Vector2d(52, 20), Vector2d(47, 24.05),
                                  Vector2d(50.05, 22.05), Vector2d(44.7, 22)}) {
        CAPTURE(d, place.x(), place.y());
        const auto at = demands(place);
        for (std::size_t j = 0; j < 3; ++j) CHECK(at[j] == Approx(middle[j]).epsilon(0.05));
    }
}

TEST_CASE("The ground that is not solid is integrated as counted by squares") {
    const Scene scene = river(0.25, two_obstacles);
    const Feeling feeling = make_feeling(scene);
    for (const Vector2d& place : {Vector2d(55, 30), Vector2d(55, 11.5), Vector2d(55, 11.7), Vector2d(50.2, 22.1),
                                  Vector2d(0, 11.5), Vector2d(51.3, 19.9), Vector2d(47.5, 24)}) {
        CAPTURE(place.x(), place.y());
        // Squares at an edge count by their middle: half of one along the longest cut is 0.1 % of the whole.
        CHECK(open_ground(feeling, place) == Approx(counted_ground(scene, place, 0.5)).epsilon(0.003));
    }
}

TEST_CASE("Dry ground counts: at the edge of a front people feel half of its depth") {
    const Scene scene = river(0.125);
    const FeltWater felt = felt_at(scene, stream(scene, 50, 60), {50, 25});
    CHECK(felt.depth == Approx(0.5).epsilon(0.05));
    CHECK(felt.velocity.x() == Approx(-1.5));
}

TEST_CASE("Without water, beside the channel and far from water people feel none") {
    const Scene scene = river(0.25);
    CHECK(felt_at(scene, MadeUpWater{}, {50, 25}).depth == 0);
    CHECK(felt_at(scene, stream(scene), {50, 11.4}).weight == 0);
    CHECK(felt_at(scene, stream(scene), {62, 25}).velocity == Vector2d(0, 0));
}

TEST_CASE("Over the joint of a periodic world people feel what they feel elsewhere") {
    Scene scene = river(0.25, {{{0, 1}, {20, 24}, 3}});
    scene.world->ends = Ends::periodic;
    scene.world->length = 20;
    scene.channel->x = {0, 20};
    scene.channel->flow = Flow::periodic;
    const MadeUpWater water = stream(scene, 0, 20);
    const Feeling feeling = make_feeling(scene);
    CHECK(felt_at(scene, water, {0, 30}).depth == Approx(felt_at(scene, water, {10, 30}).depth));
    CHECK(felt_at(scene, water, {19.9, 30}).weight == Approx(felt_at(scene, water, {9.9, 30}).weight));
    CHECK(open_ground(feeling, {19.75, 22}) == Approx(open_ground(feeling, {1.25, 22})));
    CHECK(felt_at(scene, water, {19.75, 22}).depth == Approx(1).epsilon(0.05));
}

TEST_CASE("Any number of threads feel the same") {
    const Scene scene = river(0.25, two_obstacles);
    std::vector<Vector2d> places;
    for (int i = 0; i < 100; ++i) places.emplace_back(45 + 0.1 * i, 12 + 0.25 * i);
    WaterBins bins = empty_bins(scene);
    bin_water(bins, stream(scene).view(), places);
    std::vector<FeltWater> one, four;
    feel_water(make_feeling(scene), bins, places, 1, one);
    feel_water(make_feeling(scene), bins, places, 4, four);
    for (std::size_t i = 0; i < places.size(); ++i) {
        CHECK(one[i].depth == four[i].depth);
        CHECK(one[i].velocity == four[i].velocity);
    }
}

TEST_CASE(
    "What drifts turns with half of the vorticity: all of a rigid rotation, half of a shear, nothing of an even "
    "stream") {
    const Scene scene = river(0.25);
    const Vector2d place(50.07, 25.03);
    const auto spin_in = [&](double dx_dz, double dz_dx) {
        MadeUpWater water = stream(scene);
        for (std::size_t i = 0; i < water.mass.size(); ++i) {
            water.vx[i] += static_cast<float>(dx_dz * (static_cast<double>(water.pz[i]) - place.y()));
            water.vz[i] += static_cast<float>(dz_dx * (static_cast<double>(water.px[i]) - place.x()));
        }
        WaterBins bins = empty_bins(scene);
        bin_water(bins, water.view(), {&place, 1});
        return spin_of_water(make_feeling(scene), bins, place);
    };
    // Velocities are stored as 32-bit numbers of some m/s, over half a metre.
    CHECK(spin_in(0, 0) == Approx(0).margin(1e-6));
    CHECK(spin_in(0.7, -0.7) == Approx(0.7).margin(1e-6));
    CHECK(spin_in(0.7, 0) == Approx(0.35).margin(1e-6));
    CHECK(spin_in(0.7, 0.7) == Approx(0).margin(1e-6));

    MadeUpWater line;
    for (int i = -3; i <= 3; ++i) line.add(50 + 0.1 * i, 25, 1, i, 0);
    WaterBins bins = empty_bins(scene);
    bin_water(bins, line.view(), {&place, 1});
    CHECK(spin_of_water(make_feeling(scene), bins, {50, 25}) == 0);
}

TEST_CASE("Of columns of any width people sample the same water, in mid-stream, at banks and beside boxes") {
    const double c = GENERATE(0.25, 0.5, 0.75, 1.0, 1.5, 2.0);
    const Scene scene = river(0.4642, two_obstacles);
    for (const Vector2d& place : {Vector2d(55, 30), Vector2d(55.3, 29.1), Vector2d(56, 31), Vector2d(54.03, 11.5),
                                  Vector2d(54.7, 11.8), Vector2d(52, 20.01), Vector2d(44.7, 22)}) {
        CAPTURE(c, place.x(), place.y());
        const FeltWater felt = felt_of_columns(scene, c, place);
        CHECK(felt.spread == 0.5);
        // Exact in the open; beside a box by the rule of four points a line.
        CHECK(felt.depth == Approx(0.8).epsilon(0.01));
        CHECK(felt.velocity.x() == Approx(-1.2));
        CHECK(felt.velocity.y() == Approx(0.3));
        CHECK(felt.weight == Approx(800 * open_ground(make_feeling(scene, {c, c}), place)).epsilon(0.01));
    }
}
