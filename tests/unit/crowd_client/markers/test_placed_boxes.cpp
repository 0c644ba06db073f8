#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "configs/scene/crowd.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/markers/counter_random.hpp"
#include "crowd_client/markers/placed_boxes.hpp"

using namespace wade;
using namespace wade::crowd;

namespace {

double draw(std::uint64_t stream, std::uint64_t k, double most) {
    return most * counter_uniform(11, stream, k);
}

// `count` boxes of up to `size` m on ground of length x width m, some over its edges.
std::vector<Obstacle> strewn(std::uint64_t count, double length, double width, double size) {
    std::vector<Obstacle> boxes;
    for (std::uint64_t i = 0; i < count; ++i) {
        const double x = draw(i, 0, length) - size / 2, z = draw(i, 1, width) - size / 2;
        boxes.push_back({{x, x + draw(i, 2, size)}, {z, z + draw(i, 3, size)}, static_cast<double>(i)});
    }
    return boxes;
}

bool meet(const Interval& a, const Interval& b) {
    return a.lo <= b.hi && b.lo <= a.hi;
}

std::vector<double> numbers_near(const PlacedBoxes& boxes, const Interval& x, const Interval& z) {
    std::vector<double> numbers;
    for_each_near(boxes, x, z, [&](const Obstacle& box) { numbers.push_back(box.height); });
    return numbers;
}

}  // namespace

TEST_CASE("All boxes that reach into a rectangle are found, in their order and each once") {
    struct Ground {
        std::uint64_t boxes;
        double length, width, size;
    };
    const auto ground = GENERATE(Ground{1, 100, 50, 8}, Ground{100, 120, 120, 2}, Ground{1000, 2000, 500, 30},
                                 Ground{300, 5, 5, 5}, Ground{60, 1e5, 1e5, 1e5}, Ground{40, 3000, 1, 2000});
    const PlacedBoxes boxes = place_boxes(strewn(ground.boxes, ground.length, ground.width, ground.size));
    CHECK(boxes.start.size() + boxes.listed.size() <= 1'000'001 + 16 * ground.boxes);
    std::size_t found = 0;
    for (std::uint64_t i = 0; i < 1000; ++i) {
        // Rectangles from a point to more than all of the ground, also beyond the ground and on faces of boxes.
        const double wide = i % 4 == 0 ? 0 : std::pow(10.0, draw(i, 4, 4) - 2);
        const Obstacle& some = boxes.all[i % boxes.all.size()];
        const double x0 = i % 3 == 0 ? some.x.hi : draw(i, 5, 1.4 * ground.length) - 0.2 * ground.length;
        const double z0 = i % 3 == 0 ? some.z.lo : draw(i, 6, 1.4 * ground.width) - 0.2 * ground.width;
        const Interval x{x0, x0 + wide}, z{z0, z0 + draw(i, 7, wide)};
        std::vector<double> expected;
        for (const Obstacle& box : boxes.all) {
            if (meet(box.x, x) && meet(box.z, z)) expected.push_back(box.height);
        }
        REQUIRE(numbers_near(boxes, x, z) == expected);
        found += expected.size();
    }
    CHECK(found > 300);
}

TEST_CASE("A step looks at few boxes, however many there are") {
    // A box of 1 m is listed in the cells that are nearer than 1 m, 5 x 5 m of ground at most.
    const std::uint64_t count = GENERATE(100U, 1000U, 10'000U);
    const PlacedBoxes boxes = place_boxes(strewn(count, 120, 120, 1));
    double looked_at = 0;
    constexpr std::uint64_t steps = 10'000;
    for (std::uint64_t i = 0; i < steps; ++i) {
        const std::size_t c = boxes.index(boxes.column_of(draw(i, 0, 120)), boxes.row_of(draw(i, 1, 120)));
        looked_at += boxes.start[c + 1] - boxes.start[c];
    }
    CHECK(looked_at / steps < static_cast<double>(count) * 25 / (120 * 120));
    CHECK(looked_at > 0);
}

TEST_CASE("A look ends at the first box for which the test holds") {
    const PlacedBoxes boxes = place_boxes(strewn(200, 4, 4, 3), GENERATE(0.5, 2.0, 1e4));
    std::size_t asked = 0;
    CHECK(any_near(boxes, {1, 3}, {1, 3}, [&](const Obstacle& box) { return ++asked, box.height >= 50; }));
    CHECK(asked <= 51);
    CHECK_FALSE(any_near(boxes, {1, 3}, {1, 3}, [](const Obstacle&) { return false; }));
}

TEST_CASE("A crowd goes the same ways bit for bit whether its obstacles are found by cells or asked one by one") {
    const BodyRule bodies = GENERATE(BodyRule::none, BodyRule::human);
    const NavigationRule navigation = GENERATE(NavigationRule::straight, NavigationRule::travel_time);
    Scene scene;
    scene.world->length = scene.world->width = 60;
    scene.world->ends = GENERATE(Ends::open, Ends::periodic);
    scene.crowd->markers = MarkerRule::redrawn;
    scene.crowd->bodies = bodies;
    scene.crowd->navigation.rule = navigation;
    scene.crowd->step_rate = 5;  // long steps, which meet more
    // Obstacles between the start positions, which are 2 m apart.
    for (int i = 0; i < 14; ++i) {
        for (int j = 0; j < 14; ++j) {
            const double x = 5.5 + 4 * i, z = 3.5 + 4 * j;
            scene.obstacles.push_back({{x, x + 1}, {z, z + 1}, 2});
        }
    }
    AgentGroup group;
    group.name = "all";
    group.columns = group.rows = 10;
    group.count = 100;
    group.start_x = group.start_z = 5;
    group.pitch_x = group.pitch_z = 2;
    group.goal_x = 57;
    group.goal_z = 40;
    scene.crowd->groups = {group};
    CrowdWorld crowd = make_crowd(scene), one_by_one = crowd;
    for (PlacedBoxes* boxes :
         {&one_by_one.walls.boxes, &one_by_one.markers.drawn.obstacles, &one_by_one.navigation.sight.boxes}) {
        *boxes = place_boxes(boxes->all, 1e4);
    }
    for (int k = 0; k < 60; ++k) {
        step(crowd, {});
        step(one_by_one, {});
        REQUIRE(crowd.agents.position == one_by_one.agents.position);
    }
    CHECK(crowd.agents.path_length[0] > 2);
}
