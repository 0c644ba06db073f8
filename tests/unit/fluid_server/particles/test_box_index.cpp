// Boxes near a position, and columns of water.

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"
#include "fluid_server/particles/box_index.hpp"
#include "fluid_server/particles/solids.hpp"
#include "fluid_server/particles/water_depth.hpp"
#include "lanes_that_see.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;

namespace wade::fluid::box_index_test {

constexpr float length = 60, width = 25;

class Draw {
 public:
    explicit Draw(unsigned seed) : random_(seed) {}
    float in(float lo, float hi) { return std::uniform_real_distribution<float>(lo, hi)(random_); }
    Vec3 place() { return {in(-2, length + 2), in(-0.5F, 2), in(-2, width + 2)}; }

 private:
    std::mt19937 random_;
};

// Boxes of all sizes, some of them walls along an axis, some without an end.
std::vector<Box> random_boxes(int count, Draw& draw) {
    std::vector<Box> boxes;
    for (int b = 0; b < count; ++b) {
        const float x = draw.in(0, length), z = draw.in(0, width);
        const float long_side = draw.in(0, b % 7 == 0 ? 30 : 2), short_side = draw.in(0.1F, 1);
        Box box{{x, -Box::inf, z}, {x + long_side, 3, z + short_side}};
        if (b % 2 == 0) box.hi = {x + short_side, 3, z + long_side};
        if (b % 11 == 0) box.lo[2] = -Box::inf;
        if (b % 13 == 0) box.hi[0] = Box::inf;
        boxes.push_back(box);
    }
    return boxes;
}

bool share_ground(const Box& a, const Box& b) {
    return a.lo[0] <= b.hi[0] && a.hi[0] >= b.lo[0] && a.lo[2] <= b.hi[2] && a.hi[2] >= b.lo[2];
}

// A tank with boxes of 1 x 1 m on a grid with gaps, moved about a little.
Scene tank_with_boxes(int columns, int rows, Draw& draw) {
    Scene scene = test::tank(static_cast<double>(length), static_cast<double>(width), 3, 0.25);
    for (int k = 0; k < columns * rows; ++k) {
        const double x = 1 + (k % columns) * 2.5 + static_cast<double>(draw.in(0, 0.8F));
        const double z = 1 + (k / columns) * 2.5 + static_cast<double>(draw.in(0, 0.8F));
        scene.obstacles.push_back({{x, x + 1}, {z, z + 1}, static_cast<double>(draw.in(0.5F, 2))});
    }
    return scene;
}

// The same tank with one of its boxes alone.
std::vector<Solids> one_by_one(const Scene& scene) {
    std::vector<Solids> solids;
    for (const Obstacle& obstacle : scene.obstacles) {
        Scene one = scene;
        one.obstacles = {obstacle};
        solids.emplace_back(one);
    }
    return solids;
}

}  // namespace wade::fluid::box_index_test

TEST_CASE("an index finds all boxes near a place, in order and each once, and few others", "[fluid][solids]") {
    using namespace box_index_test;
    Draw draw(1);
    for (const int count : {0, 1, 2, 13, 300}) {
        const std::vector<Box> boxes = random_boxes(count, draw);
        const BoxIndex index{boxes};
        std::size_t missed = 0, out_of_order = 0, found_in_all = 0, there = 0;
        for (int asked = 0; asked < 1000; ++asked) {
            const Vec3 x = draw.place();
            const Box question{x, {x[0] + draw.in(0, 4), x[1] + 1, x[2] + draw.in(0, 2)}};
            BoxNumbers found;
            index.find(question, found);
            const std::span<const std::uint32_t> here = index.at(x[0], x[2]);
            for (std::uint32_t b = 0; b < boxes.size(); ++b) {
                const bool is_there = share_ground(boxes[b], question);
                there += is_there ? 1U : 0U;
                missed += is_there && !std::binary_search(found.begin(), found.end(), b) ? 1U : 0U;
                missed += share_ground(boxes[b], {x, x}) && !std::binary_search(here.begin(), here.end(), b) ? 1U : 0U;
            }
            const auto descends = [](std::uint32_t a, std::uint32_t b) { return a >= b; };
            out_of_order += std::adjacent_find(found.begin(), found.end(), descends) != found.end() ? 1U : 0U;
            out_of_order += std::adjacent_find(here.begin(), here.end(), descends) != here.end() ? 1U : 0U;
            found_in_all += found.size();
        }
        CHECK(missed == 0);
        CHECK(out_of_order == 0);
        // Cells are about as large as half a box has ground, a few metres here: a question spans twice its own ground.
        if (count == 300) CHECK(found_in_all < 3 * there);
    }
}

TEST_CASE("many boxes answer as one after the other does: sight, contact, the clamp", "[fluid][solids]") {
    using namespace box_index_test;
    Draw draw(2);
    const Scene scene = tank_with_boxes(22, 9, draw);
    const Solids solids(scene);
    const std::vector<Solids> each = one_by_one(scene);
    constexpr std::size_t lanes = 8;
    constexpr float dt = 0.02F;
    int wrong = 0, hidden = 0, touched = 0, clamped = 0, mirrors_of_boxes = 0;
    for (int asked = 0; asked < 2000; ++asked) {
        const Vec3 middle = draw.place();
        std::array<float, lanes> x{}, y{}, z{};
        BlockVelocities v{};
        std::array<Vec3, lanes> places_of_all{};
        Box box{{Box::inf, Box::inf, Box::inf}, {-Box::inf, -Box::inf, -Box::inf}};
        for (std::size_t l = 0; l < lanes; ++l) {
            x[l] = middle[0] + draw.in(-1, 1), y[l] = middle[1] + draw.in(0, 0.3F), z[l] = middle[2] + draw.in(0, 0.4F);
            v.x[l] = draw.in(-9, 9), v.y[l] = draw.in(-9, 9), v.z[l] = draw.in(-9, 9);
            const Vec3 at = places_of_all[l] = {x[l], y[l], z[l]};
            for (std::size_t k = 0; k < 3; ++k) {
                box.lo[k] = std::min(box.lo[k], at[k]), box.hi[k] = std::max(box.hi[k], at[k]);
            }
        }
        const Places places{x.data(), y.data(), z.data()};
        const Vec3 to{middle[0] + draw.in(-1, 1), middle[1] + draw.in(-0.3F, 0.6F), middle[2] + draw.in(-0.4F, 0.8F)};
        BoxNumbers near;
        solids.find_obstacles(box, near);
        const std::span<const Vec3> asked_of(places_of_all.data(), std::min(lanes, cluster_size_here()));
        unsigned seen = (1U << asked_of.size()) - 1;
        std::vector<Box> boxes_near;
        for (const std::uint32_t o : near) boxes_near.push_back(solids.obstacles()[o]);
        bool is_near = false;
        BlockVelocities slowed = v;
        std::vector<std::array<float, 4>> told, expected;  // obstacle, then what it took
        Vec3 pushed{x[0], y[0], z[0]};
        std::vector<Mirror> mirrors, mirrors_of_one;
        std::size_t boxes_with_mirrors = 0;
        const BoxNumbers first{0};
        for (std::uint32_t o = 0; o < each.size(); ++o) {
            seen &= test::lanes_that_see(solids, asked_of, to, Mirror{}, {&solids.obstacles()[o], 1});
            is_near = is_near || each[o].obstacle_near(box, first);
            each[o].mirrors_near(box, first, mirrors_of_one);
            boxes_with_mirrors += std::any_of(mirrors_of_one.begin(), mirrors_of_one.end(),
                                              [](const Mirror& m) { return m.obstacle >= 0; })
                                      ? 1U
                                      : 0U;
            each[o].apply_contact(places, lanes, dt, slowed, [&](std::uint32_t, std::size_t, const Vec3& taken) {
                expected.push_back({static_cast<float>(o), taken[0], taken[1], taken[2]});
            });
            each[o].clamp(pushed);
        }
        // Lines of sight longer than the support radius do not matter: only shorter ones must agree.
        unsigned short_lines = 0;
        for (std::size_t l = 0; l < asked_of.size(); ++l) {
            const float dx = x[l] - to[0], dy = y[l] - to[1], dz = z[l] - to[2];
            short_lines |= dx * dx + dy * dy + dz * dz < 0.25F ? 1U << l : 0U;
        }
        const unsigned seen_by_index = test::lanes_that_see(solids, asked_of, to, Mirror{}, boxes_near);
        wrong += (seen_by_index & short_lines) != (seen & short_lines) ? 1 : 0;
        hidden += (seen & short_lines) != short_lines ? 1 : 0;
        wrong += solids.obstacle_near(box, near) != is_near ? 1 : 0;
        solids.mirrors_near(box, near, mirrors);
        std::vector<int> numbers;
        for (const Mirror& mirror : mirrors) {
            if (mirror.obstacle >= 0) numbers.push_back(mirror.obstacle);
        }
        wrong += std::is_sorted(numbers.begin(), numbers.end()) ? 0 : 1;
        const auto distinct = std::unique(numbers.begin(), numbers.end()) - numbers.begin();
        wrong += static_cast<std::size_t>(distinct) != boxes_with_mirrors ? 1 : 0;
        mirrors_of_boxes += static_cast<int>(distinct);
        solids.apply_contact(places, lanes, dt, v, [&](std::uint32_t o, std::size_t, const Vec3& taken) {
            told.push_back({static_cast<float>(o), taken[0], taken[1], taken[2]});
        });
        wrong += told != expected || v.x != slowed.x || v.y != slowed.y || v.z != slowed.z ? 1 : 0;
        touched += told.empty() ? 0 : 1;
        Vec3 free{x[0], y[0], z[0]};
        clamped += solids.clamp(free) ? 1 : 0;
        wrong += free != pushed ? 1 : 0;
    }
    CHECK(wrong == 0);
    // Each question had both answers often.
    for (const int answers : {hidden, touched, clamped, mirrors_of_boxes}) CHECK(answers > 100);
}

namespace water_depth_test {

namespace {

constexpr double spacing = 0.05;

// A stream 0.4 m deep in a channel 4 m long and 0.6 m wide.
Scene stream() {
    Scene scene = test::tank(4, 0.6, 0.4, spacing);
    scene.fluid->max_particles = 60000;
    return scene;
}

// Adds a box of water on a lattice, from the bed up.
void add_box(Particles& particles, Interval x, double top, Interval z) {
    for (double a = x.lo + spacing / 2; a < x.hi; a += spacing) {
        for (double y = spacing / 2; y < top; y += spacing) {
            for (double b = z.lo + spacing / 2; b < z.hi; b += spacing) {
                particles.add({static_cast<float>(a), static_cast<float>(y), static_cast<float>(b)}, {0, 0, 0},
                              Kind::fluid, 0);
            }
        }
    }
}

}  // namespace

TEST_CASE("water that stands more than twice as deep as the scene says counts with its depth", "[fluid][depth]") {
    WaterDepth depth(stream());
    Particles particles(60000);
    add_box(particles, {0, 4}, 0.4, {0, 0.6});
    CHECK(depth.now(particles, 0.4) == 0.4);
    Particles jump(60000);
    add_box(jump, {0, 1}, 1.5, {0, 0.6});
    add_box(jump, {1, 4}, 0.4, {0, 0.6});
    CHECK(depth.now(jump, 1.5) == Approx(1.5).epsilon(0.02));  // a column holds whole particles
    // Not yet twice as deep.
    Particles wave(60000);
    add_box(wave, {0, 4}, 0.75, {0, 0.6});
    CHECK(depth.now(wave, 0.75) == 0.4);
}

TEST_CASE("a thin sheet does not count as deep water", "[fluid][depth]") {
    WaterDepth depth(stream());
    Particles particles(60000);
    add_box(particles, {0, 4}, 0.4, {0, 0.6});
    add_box(particles, {0, spacing}, 1.4, {0, 0.6});  // runs up a wall, one particle thick
    CHECK(depth.now(particles, 1.4) == 0.4);
}

TEST_CASE("ten layers and fewer are never measured", "[fluid][depth]") {
    Scene scene = stream();
    scene.channel->water_blocks.at(0).depth = 0.1;
    WaterDepth depth(scene);
    Particles particles(60000);
    add_box(particles, {0, 4}, 0.5, {0, 0.6});  // five times as deep: ten layers
    CHECK(depth.now(particles, 0.5) == 0.1);
}

}  // namespace water_depth_test
