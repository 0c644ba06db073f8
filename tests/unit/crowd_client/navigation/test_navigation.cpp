#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <span>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/markers/counter_random.hpp"
#include "crowd_client/navigation/travel_time_fields.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using namespace wade::crowd::testing;

namespace {

Scene navigated_scene(double length, double width, std::vector<Obstacle> obstacles) {
    Scene scene;
    scene.world->length = length;
    scene.world->width = width;
    scene.obstacles = std::move(obstacles);
    scene.crowd->goal_radius = 1;
    scene.crowd->navigation.rule = NavigationRule::travel_time;
    return scene;
}

AgentGroup people(const std::string& name, int columns, int rows, Vector2d start, double pitch, Vector2d goal) {
    AgentGroup group;
    group.name = name;
    group.columns = columns;
    group.rows = rows;
    group.count = columns * rows;
    group.start_x = start.x();
    group.start_z = start.y();
    group.pitch_x = group.pitch_z = pitch;
    group.goal_x = goal.x();
    group.goal_z = goal.y();
    return group;
}

// A court that is open on the side away from the goal, with walls of this thickness.
Scene court(double thickness) {
    Scene scene = navigated_scene(
        30, 20,
        {{{16 - thickness, 16}, {5, 15}, 3}, {{8, 16}, {5, 5 + thickness}, 3}, {{8, 16}, {15 - thickness, 15}, 3}});
    scene.crowd->groups = {people("inside", 4, 3, {11, 8.7}, 1, {26, 10})};
    return scene;
}

// Two rooms with a door of this width in a thin wall, pillars before it.
Scene rooms(double door) {
    Scene scene = navigated_scene(20, 20,
                                  {{{10, 10.2}, {0, 4 - door / 2}, 3},
                                   {{10, 10.2}, {4 + door / 2, 20}, 3},
                                   {{7, 7.3}, {6, 6.3}, 3},
                                   {{7, 7.3}, {8, 8.3}, 3}});
    scene.crowd->groups = {people("left", 1, 1, {3, 16}, 1, {17, 16})};
    return scene;
}

Scene village() {
    Scene scene = navigated_scene(40, 30, {});
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const double x = 6 + 11 * i, z = 3 + 9 * j;
            scene.obstacles.push_back({{x, x + 6}, {z, z + 6}, 3});
        }
    }
    scene.crowd->groups = {people("east", 1, 1, {1, 1}, 1, {38, 28})};
    return scene;
}

void take_steps(CrowdWorld& crowd, int steps) {
    for (int k = 0; k < steps && !crowd.active.empty(); ++k) step(crowd, {});
}

Vector2d some_place(const Scene& scene, std::uint64_t k) {
    return {scene.world->length * counter_uniform(7, 1, k), scene.world->width * counter_uniform(7, 2, k)};
}

bool is_free(const Scene& scene, const Vector2d& p, double clearance) {
    return std::none_of(scene.obstacles.begin(), scene.obstacles.end(), [&](const Obstacle& box) {
        const Obstacle wide = grown(box, clearance);
        return wide.x.lo < p.x() && p.x() < wide.x.hi && wide.z.lo < p.y() && p.y() < wide.z.hi;
    });
}

}  // namespace

TEST_CASE("Out of a court that is open at the back people find by travel times, and not straight") {
    const double thickness = GENERATE(1.0, 0.1);
    const BodyRule bodies = GENERATE(BodyRule::none, BodyRule::fast, BodyRule::human);
    Scene scene = court(thickness);
    scene.crowd->bodies = bodies;
    if (bodies != BodyRule::none) scene.crowd->markers = MarkerRule::redrawn;
    // The route is 29 m or less, 23 s.
    CrowdWorld crowd = make_crowd(scene);
    take_steps(crowd, 60 * 30);
    CHECK(crowd.arrived == crowd.agents.size());
    scene.crowd->navigation.rule = NavigationRule::straight;
    CrowdWorld straight = make_crowd(scene);
    take_steps(straight, 60 * 30);
    CHECK(straight.arrived == 0);
}

TEST_CASE("What is in sight does not depend on how the boxes are found") {
    Sight sight{{}, GENERATE(0.0, 0.25, 1.5)};
    std::vector<Obstacle> boxes;
    for (std::uint64_t i = 0; i < 80; ++i) {
        const auto draw = [&](std::uint64_t k, double most) { return most * counter_uniform(5, i, k); };
        const double x = draw(0, 120), z = draw(1, 60);
        boxes.push_back({{x, x + draw(2, 3)}, {z, z + draw(3, 3)}, 3});
    }
    sight.boxes = place_boxes(boxes);
    Sight one_by_one = sight;
    one_by_one.boxes = place_boxes(boxes, 1e4);
    std::array<int, 3> views{};
    int seen = 0;
    constexpr int looks = 3000;
    for (std::uint64_t k = 0; k < looks; ++k) {
        const auto draw = [&](std::uint64_t i, double most) { return most * counter_uniform(6, k, i); };
        const Vector2d p(draw(0, 130) - 5, draw(1, 70) - 5), q(draw(2, 130) - 5, draw(3, 70) - 5);
        const Vector2d to = p + std::pow(draw(4, 1), 3) * (q - p);  // near and far
        REQUIRE(in_sight(sight, p, to) == in_sight(one_by_one, p, to));
        seen += in_sight(sight, p, to) ? 1 : 0;
        const Interval x{p.x(), p.x() + draw(5, 1)}, z{p.y(), p.y() + draw(6, 1)};
        const View view = view_of(sight, x, z, to);
        REQUIRE(view == view_of(one_by_one, x, z, to));
        std::vector<std::uint32_t> hiding{7};
        REQUIRE(view == view_of(sight, x, z, to, &hiding));
        REQUIRE(hiding.front() == 7);
        REQUIRE((hiding.size() > 1) == (view == View::unknown));
        for (std::uint64_t i = 0; i < 10 && view == View::unknown; ++i) {
            const Vector2d inside(x.lo + draw(10 + i, x.length()), z.lo + draw(20 + i, z.length()));
            REQUIRE(in_sight(sight, inside, to, std::span(hiding).subspan(1)) == in_sight(sight, inside, to));
        }
        ++views[static_cast<std::size_t>(view)];
    }
    CHECK(seen > looks / 10);
    CHECK(seen < looks * 9 / 10);
    for (const int count : views) CHECK(count > 50);
}

// The detour of 0.5 m is the clearance, rounded up to cells. Markers make a lone agent's path waver.
TEST_CASE("A lone agent's way is hardly longer than a taut string") {
    Scene scene = court(1);
    scene.crowd->groups = {people("one", 1, 1, {12, 10.5}, 1, {26, 10})};
    CrowdWorld crowd = make_crowd(scene);
    take_steps(crowd, 60 * 30);
    REQUIRE(crowd.arrived == 1);
    const double taut = std::hypot(4, 4.5) + 8 + std::hypot(10, 5) - scene.crowd->goal_radius;
    CHECK(crowd.agents.path_length[0] > taut - 0.1);
    CHECK(crowd.agents.path_length[0] < 1.1 * taut + 0.5);
}

TEST_CASE("From every free place the ways lead to the goal, and at no place into an obstacle") {
    Scene scene = GENERATE(court(1), court(0.1), rooms(1.2), village());
    scene.crowd->navigation.cell = GENERATE(0.2, 0.5, 0.8);
    scene.crowd->body_radius = 0.2;
    const Agents agents = make_agents(scene);
    const Navigation navigation = make_navigation(scene, agents);
    const Walls walls = make_walls(scene);
    const double clearance = navigation.sight.clearance, stride = 0.04;
    const TravelTimeField& field = navigation.fields.at(0);
    for (std::uint64_t k = 0; k < 60; ++k) {
        Vector2d p = some_place(scene, k);
        if (!is_free(scene, p, 0)) continue;
        INFO("from " << p.x() << ", " << p.y() << " with cells of " << navigation.grid.dx);
        double walked = 0, length = -1;
        bool arrived = false;
        for (int i = 0; i < 3000 && !arrived; ++i) {
            const auto way = way_from(navigation, field, p, field.goal - p);
            REQUIRE(way.has_value());
            if (length < 0) length = way->norm();
            const Vector2d to = p + stride * way->normalized();
            REQUIRE(is_free(scene, to, 0));
            if (is_free(scene, p, clearance + stride)) REQUIRE(is_free(scene, to, clearance));
            walked += stride;
            p = slide(walls, p, to - p, ends_for(walls, p, 0, false));
            arrived = (field.goal - p).norm() < 0.2;
        }
        CHECK(arrived);
        CHECK(walked < 1.1 * length + 1);
    }
}

TEST_CASE("A gap that is too narrow for bodies is no way") {
    Scene scene = rooms(0.4);
    scene.crowd->body_radius = 0.25;
    CHECK_THROWS_AS(make_crowd(scene), ConfigurationError);
    scene.crowd->body_radius = 0.1;
    scene.crowd->navigation.cell = 0.2;
    CHECK_NOTHROW(make_crowd(scene));
}

TEST_CASE("With the goal in sight, people walk as they do straight, to the bit") {
    Scene scene = navigated_scene(40, 20, {{{18, 20}, {0, 6}, 3}, {{18, 20}, {14, 20}, 3}});
    scene.crowd->groups = {people("through", 4, 4, {2, 8.5}, 1, {38, 10})};
    CrowdWorld crowd = make_crowd(scene);
    CHECK(finds_routes(crowd.navigation));
    scene.crowd->navigation.rule = NavigationRule::straight;
    CrowdWorld straight = make_crowd(scene);
    CHECK_FALSE(finds_routes(straight.navigation));
    for (int k = 0; k < 300; ++k) {
        step(crowd, {});
        step(straight, {});
        REQUIRE(crowd.agents.position == straight.agents.position);
    }
}

TEST_CASE("Without obstacles and crowding there are no fields") {
    Scene scene = navigated_scene(40, 20, {});
    scene.crowd->groups = {people("a", 4, 4, {2, 8}, 1, {38, 10})};
    CHECK_FALSE(finds_routes(make_crowd(scene).navigation));
    scene.crowd->navigation.crowding = 1;
    CHECK(finds_routes(make_crowd(scene).navigation));
}

TEST_CASE("With crowding the way leads through the door at which fewer people wait") {
    Scene scene = navigated_scene(30, 20, {{{15, 16}, {0, 4}, 3}, {{15, 16}, {6, 14}, 3}, {{15, 16}, {16, 20}, 3}});
    scene.crowd->groups = {people("one", 1, 1, {8, 9.5}, 1, {22, 9}), people("waiting", 6, 6, {12, 3.7}, 0.5, {29, 5})};
    const auto way = [&](double crowding) {
        scene.crowd->navigation.crowding = crowding;
        const CrowdWorld crowd = make_crowd(scene);
        const Vector2d rest = crowd.agents.goal[0] - crowd.agents.position[0];
        return *way_from(crowd.navigation, crowd.navigation.fields[0], crowd.agents.position[0], rest);
    };
    CHECK(way(0).y() < 0);  // 1.6 m shorter
    CHECK(way(1).y() > 0);
    CHECK(way(1).norm() > way(0).norm());
}

TEST_CASE("Fields with crowding are solved again where people have moved, once with every_s 0") {
    const double every = GENERATE(0.0, 0.5);
    Scene scene = navigated_scene(30, 20, {{{15, 16}, {0, 9}, 3}, {{15, 16}, {11, 20}, 3}});
    scene.crowd->groups = {people("a", 5, 5, {2, 3}, 0.7, {28, 10})};
    scene.crowd->navigation.crowding = 1;
    scene.crowd->navigation.every = every;
    CrowdWorld crowd = make_crowd(scene);
    const std::vector<double> first = crowd.navigation.fields[0].travel;
    take_steps(crowd, 14);
    CHECK(crowd.navigation.fields[0].travel == first);
    take_steps(crowd, 1);
    CHECK((crowd.navigation.fields[0].travel == first) == (every == 0));
}

TEST_CASE("Crowds that find their ways have the same bits for any number of threads") {
    Scene scene = navigated_scene(60, 44, {{{28, 30}, {0, 18}, 3}, {{28, 30}, {24, 44}, 3}, {{40, 44}, {16, 26}, 3}});
    scene.crowd->markers = MarkerRule::redrawn;
    scene.crowd->bodies = BodyRule::fast;
    scene.crowd->navigation.crowding = 1;
    scene.crowd->navigation.every = 0.5;
    scene.crowd->groups = {people("a", 15, 40, {1, 1}, 1, {58, 22}), people("b", 9, 40, {46, 1}, 1, {2, 30}),
                           people("c", 4, 20, {18, 5}, 1, {58, 40})};
    CrowdWorld one = make_crowd(scene);
    for (int k = 0; k < 32; ++k) step(one, {});
    for (const int threads : {2, 4}) {
        CrowdWorld several = make_crowd(scene);
        several.threads = threads;
        for (int k = 0; k < 32; ++k) step(several, {});
        REQUIRE(several.agents.position == one.agents.position);
    }
}

TEST_CASE("In a periodic world ways lead over the joint, lap by lap") {
    const int direction = GENERATE(1, -1);
    // Two walls across the corridor, each with a door on another side; the joint lies between two of them.
    Scene scene = navigated_scene(20, 10, {{{5, 6}, {2, 10}, 3}, {{15, 16}, {0, 8}, 3}});
    scene.world->ends = Ends::periodic;
    scene.crowd->groups = {people("round", 1, 1, {10, 5}, 1, {10.0 + direction * 50, 5})};
    CrowdWorld crowd = make_crowd(scene);
    take_steps(crowd, 150 * 30);
    CHECK(crowd.arrived == 1);
    CHECK(crowd.agents.laps[0] == (direction > 0 ? 2 : -2));
    scene.crowd->navigation.rule = NavigationRule::straight;
    CrowdWorld straight = make_crowd(scene);
    take_steps(straight, 150 * 30);
    CHECK(straight.arrived == 0);
}

TEST_CASE("An agent without a way to its goal is refused with its number, group and goal") {
    Scene scene = court(1);
    scene.obstacles.push_back({{8, 9}, {5, 15}, 3});
    CHECK_THROWS_WITH(make_crowd(scene), Catch::Contains("/crowd/groups/0") && Catch::Contains("agent 0") &&
                                             Catch::Contains("group \"inside\"") && Catch::Contains("(26, 10) m") &&
                                             Catch::Contains("/crowd/body_radius_m") && Catch::Contains("allowed"));
    scene.crowd->navigation.rule = NavigationRule::straight;
    CHECK_NOTHROW(make_crowd(scene));
}

TEST_CASE("More cells than memory should hold are refused") {
    Scene scene = court(1);
    scene.world->length = 20000;
    scene.world->width = 20000;
    CHECK_THROWS_WITH(make_crowd(scene),
                      Catch::Contains("/crowd/navigation/cell_m is 0.5") && Catch::Contains("allowed"));
}
