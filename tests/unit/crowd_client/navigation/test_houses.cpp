#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "crowd_client/bodies/obstacles_near.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/markers/counter_random.hpp"
#include "crowd_client/markers/marker_lanes.hpp"
#include "crowd_client/water/felt_water.hpp"
#include "made_up_water.hpp"

namespace wade::crowd::houses_test {

using namespace wade::crowd::testing;

using Plan = std::vector<Vector2d>;

MapPolygon polygon_of(const Plan& plan) {
    MapPolygon polygon{{{}}};
    for (const Vector2d& p : plan) polygon.rings[0].push_back({p.x(), p.y()});
    return polygon;
}

Plan rectangle(double x_lo, double x_hi, double z_lo, double z_hi) {
    return {{x_lo, z_lo}, {x_hi, z_lo}, {x_hi, z_hi}, {x_lo, z_hi}};
}

Vector2d turned(const Vector2d& p, double degrees, const Vector2d& about) {
    const double a = degrees * std::numbers::pi / 180;
    const Vector2d r = p - about;
    return about + Vector2d(std::cos(a) * r.x() - std::sin(a) * r.y(), std::sin(a) * r.x() + std::cos(a) * r.y());
}

Scene site_of(double length, double width, const std::vector<Plan>& plans) {
    Scene scene = dry_scene(length, width);
    scene.site.emplace();
    for (const Plan& plan : plans) scene.site->houses.emplace_back().polygon = polygon_of(plan);
    return scene;
}

bool is_in(const Scene& scene, const Vector2d& p) {
    return std::any_of(scene.site->houses.begin(), scene.site->houses.end(), [&](const House& house) {
        return contains(house.polygon, {p.x(), p.y()});
    });
}

// An L, a star with sharp inner corners, a wall, and two houses that share one.
std::vector<Plan> odd_houses() {
    Plan star;
    for (int k = 0; k < 10; ++k) {
        const double r = k % 2 == 0 ? 8 : 2.5, a = 0.3 + k * std::numbers::pi / 5;
        star.push_back(Vector2d(70, 30) + r * Vector2d(std::cos(a), std::sin(a)));
    }
    Plan wall, left, right;
    for (const Vector2d& p : rectangle(20, 60, 44, 44.3)) wall.push_back(turned(p, -12, {40, 44}));
    for (const Vector2d& p : rectangle(20, 30, 18, 26)) left.push_back(turned(p, 17, {30, 22}));
    for (const Vector2d& p : rectangle(30, 41, 18, 26)) right.push_back(turned(p, 17, {30, 22}));
    return {{{10, 5}, {22, 2}, {25, 9}, {17, 10}, {18, 15}, {12, 16}}, star, wall, left, right};
}

constexpr Interval ends_of_world{0, 100};

TEST_CASE("No step, however long and wherever it starts, ends in a house of any plan or crosses one") {
    const Scene scene = site_of(100, 50, odd_houses());
    const Walls walls = make_walls(scene);
    for (std::uint64_t run = 0; run < 150; ++run) {
        Vector2d p(100 * counter_uniform(1, run, 0), 50 * counter_uniform(1, run, 1));
        if (is_in(scene, p)) continue;
        p = place_outside(walls, p).value();
        for (std::uint64_t i = 1; i <= 100; ++i) {
            const double length = std::pow(10.0, 8 * counter_uniform(2, run, i) - 5);
            const double angle = 2 * std::numbers::pi * counter_uniform(3, run, i);
            const Vector2d d(length * std::cos(angle), length * std::sin(angle)), q = slide(walls, p, d, ends_of_world);
            REQUIRE_FALSE(is_in(scene, q));
            REQUIRE((q.x() >= 0 && q.x() <= 100 && q.y() >= 0 && q.y() <= 50));
            // A step that is not shortened crosses no house.
            if (q == p + d) REQUIRE_FALSE(meets_a_house(walls.houses, p, q));
            p = q;
        }
    }
}

TEST_CASE("A step into a side at an angle slides along it, and on past its corner") {
    Plan plan;
    for (const Vector2d& p : rectangle(40, 60, 20, 30)) plan.push_back(turned(p, 30, {40, 20}));
    const Walls walls = make_walls(site_of(100, 50, {plan}));
    const Vector2d along(std::cos(std::numbers::pi / 6), 0.5), outward(0.5, -std::cos(std::numbers::pi / 6));
    const Vector2d start = Vector2d(40, 20) + 5 * along + outward;
    const Vector2d end = slide(walls, start, 3 * along - 4 * outward, ends_of_world);
    // One skin before the side, to the rounding of positions of 100 m.
    CHECK((end - (start + 3 * along - (1 - Walls::skin) * outward)).norm() < 1e-12);
    // The corner is 15 m on; behind it the rest of the step leads round it freely.
    const Vector2d past = slide(walls, start, 18 * along - 4 * outward, ends_of_world);
    CHECK((past - start).dot(along) == Approx(18).margin(1e-5));
}

TEST_CASE("Walls of touching houses are slid along without a stop at the seam") {
    const Walls walls = make_walls(site_of(100, 50, odd_houses()));
    const Vector2d along = turned({1, 0}, 17, {0, 0}), outward = turned({0, -1}, 17, {0, 0});
    const Vector2d seam = turned({30, 18}, 17, {30, 22});
    const Vector2d end = slide(walls, seam - 2 * along + 0.01 * outward, 4 * along - outward, ends_of_world);
    CHECK((end - seam).dot(along) == Approx(2).margin(1e-5));
}

TEST_CASE("A house that is a rectangle along the axes stops, hides and feels as the box does") {
    Scene boxed = dry_scene(100, 50, {{{40, 50}, {20, 30}, 1}});
    Scene built = site_of(100, 50, {rectangle(40, 50, 20, 30)});
    built.fluid->shallow_water.cell_size = boxed.fluid->particle_spacing;  // so that both feel as far
    const Walls box = make_walls(boxed), house = make_walls(built);
    const Feeling felt_box = make_feeling(boxed), felt_house = make_feeling(built);
    const Sight seen_box{place_boxes(boxed.obstacles), 0, {}}, seen_house{{}, 0, house.houses};
    for (std::uint64_t k = 0; k < 400; ++k) {
        const Vector2d p(35 + 20 * counter_uniform(1, k, 0), 15 + 20 * counter_uniform(1, k, 1));
        if (boxed.obstacles[0].x.contains(p.x()) && boxed.obstacles[0].z.contains(p.y())) continue;
        const Vector2d d(20 * counter_uniform(2, k, 0) - 10, 20 * counter_uniform(2, k, 1) - 10);
        // Both stop a skin before the face and keep what goes along it; 1e-5 m is what two turns at a corner add up.
        CHECK((slide(box, p, d, ends_of_world) - slide(house, p, d, ends_of_world)).norm() < 1e-5);
        CHECK(open_ground(felt_box, p) == Approx(open_ground(felt_house, p)).epsilon(1e-9));
        const Vector2d to = p + d;
        const bool ends_in_it = boxed.obstacles[0].x.contains(to.x()) && boxed.obstacles[0].z.contains(to.y());
        if (!ends_in_it) CHECK(in_sight(seen_box, p, to) == in_sight(seen_house, p, to));
        std::size_t limits = 0, of_box = 0;
        for_each_within(house, p, 3, [&](const Vector2d&, double) { ++limits; });
        for_each_within(box, p, 3, [&](const Vector2d&, double) { ++of_box; });
        CHECK(std::min<std::size_t>(limits, 1) == of_box);
    }
}

TEST_CASE("The ground that a turned house leaves is that of the straight one") {
    Plan plan;
    for (const Vector2d& p : rectangle(40, 60, 20, 30)) plan.push_back(turned(p, 33, {40, 20}));
    const Feeling straight = make_feeling(site_of(100, 60, {rectangle(40, 60, 20, 30)}));
    const Feeling at_angle = make_feeling(site_of(100, 60, {plan}));
    for (const Vector2d& p : {Vector2d(39.8, 25), Vector2d(50, 19.7), Vector2d(39.9, 19.9), Vector2d(60.2, 24)}) {
        // Lines across a turned side have a kink where it cuts the rim, which the rule of four points rounds by some per mille.
        CHECK(open_ground(at_angle, turned(p, 33, {40, 20})) == Approx(open_ground(straight, p)).epsilon(0.004));
    }
}

TEST_CASE("No markers stand in a turned house, and all beside it") {
    Scene scene = site_of(30, 30, {});
    Plan plan;
    for (const Vector2d& p : rectangle(10, 20, 12, 18)) plan.push_back(turned(p, 30, {15, 15}));
    scene.site->houses.emplace_back().polygon = polygon_of(plan);
    scene.crowd->groups = {row_of_people(1, {2, 2}, 1, {28, 28})};
    const std::size_t all = place_markers(dry_scene(30, 30)).size(), left = place_markers(scene).size();
    // 16 markers a square metre, thrown at random: 60 m2 of house take 960, within five deviations of a Poisson process.
    CHECK(static_cast<double>(all - left) == Approx(960).margin(155));
    scene.crowd->markers = MarkerRule::redrawn;
    Markers drawn = place_markers(scene);
    redraw(drawn.drawn, 3);
    MarkerLanes<float> lanes;
    std::size_t kept = 0;
    for (int row = 0; row < drawn.grid.rows; ++row) {
        for (int column = 0; column < drawn.grid.columns; ++column) {
            draw_markers(lanes, drawn.drawn, column, row);
            for (std::size_t m = 0; m < lanes.count; ++m) {
                if (lanes.x[m] > 1e6F) continue;
                ++kept;
                const Vector2d at(lanes.origin_x + drawn.drawn.moved.x() + static_cast<double>(lanes.x[m]),
                                  lanes.origin_z + drawn.drawn.moved.y() + static_cast<double>(lanes.z[m]));
                REQUIRE_FALSE(is_in(scene, at));
            }
        }
    }
    const auto in_all = static_cast<double>(drawn.grid.cells() * 64);
    CHECK(in_all - static_cast<double>(kept) == Approx(960).margin(100));
}

TEST_CASE("Bodies in a street turned by 30 degrees touch no wall and walk as fast as along the axes") {
    const auto walked = [](double degrees, BodyRule rule) {
        Plan below, above;
        for (const Vector2d& p : rectangle(20, 60, 20, 28)) below.push_back(turned(p, degrees, {40, 30}));
        for (const Vector2d& p : rectangle(20, 60, 32, 40)) above.push_back(turned(p, degrees, {40, 30}));
        Scene scene = site_of(80, 60, {below, above});
        scene.crowd->bodies = rule;
        scene.crowd->markers = MarkerRule::redrawn;
        for (int row = 0; row < 4; ++row) {
            for (int column = 0; column < 6; ++column) {
                const Vector2d start = turned(Vector2d(22 + column, 28.8 + 0.8 * row), degrees, {40, 30});
                scene.crowd->groups.push_back(row_of_people(1, start, 1, turned({56, 30}, degrees, {40, 30})));
            }
        }
        CrowdWorld crowd = make_crowd(scene);
        for (int k = 0; k < 150; ++k) {
            step(crowd, {});
            for (const std::uint32_t id : crowd.active) {
                const Vector2d& p = crowd.agents.position[id];
                for (const HouseSide& side : crowd.walls.houses.sides) {
                    REQUIRE((p - side.at(side.nearest(p))).norm() >= crowd.agents.body.radius[id]);
                }
                REQUIRE_FALSE(is_in(scene, p));
            }
        }
        double sum = 0;
        for (std::size_t id = 0; id < crowd.agents.size(); ++id) {
            sum +=
                (crowd.agents.position[id] - turned({22, 30}, degrees, {40, 30})).dot(turned({1, 0}, degrees, {0, 0}));
        }
        return sum / static_cast<double>(crowd.agents.size());
    };
    for (const BodyRule rule : {BodyRule::fast, BodyRule::human}) {
        const double straight = walked(0, rule);
        CHECK(straight > 12);  // of 19.5 m that 15 s at 1.3 m/s would be, with a crowd of 2 people/m2 before most
        // Both are one random draw. Means of 24 people that obstruct one another differ by some per cent.
        CHECK(walked(30, rule) == Approx(straight).epsilon(0.08));
    }
}

TEST_CASE("Ground in and near a house is closed for ways, and no more") {
    Plan plan;
    for (const Vector2d& p : rectangle(10, 20, 12, 18)) plan.push_back(turned(p, 30, {15, 15}));
    const PlacedHouses houses = place_houses({polygon_of(plan)});
    TravelGrid grid = travel_grid({0, 0}, {30, 30}, 0.5);
    close_houses(grid, houses, 0.25);
    for (int row = 0; row < grid.rows; ++row) {
        for (int column = 0; column < grid.columns; ++column) {
            const Vector2d p = grid.place(column, row);
            double nearest = 1e9;
            for (const HouseSide& side : houses.sides) {
                nearest = std::min(nearest, (p - side.at(side.nearest(p))).norm());
            }
            const bool closed = contains(houses.plans[0], {p.x(), p.y()}) || nearest < 0.25;
            REQUIRE(((grid.closed[grid.node(column, row)] & TravelGrid::node_closed) != 0) == closed);
        }
    }
}

}  // namespace wade::crowd::houses_test
