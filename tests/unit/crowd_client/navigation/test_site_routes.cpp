#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <tuple>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/crowd.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/navigation/site_routes.hpp"
#include "made_up_water.hpp"

namespace wade::crowd::site_routes_test {

using namespace wade::crowd::testing;

MapPolygon square(double x, double z, double half) {
    return {{{{x - half, z - half}, {x + half, z - half}, {x + half, z + half}, {x - half, z + half}}}};
}

SiteShelter shelter(const std::string& name, double x, double z, int capacity) {
    return {name, square(x, z, 3), capacity};
}

// 60 x 40 m with a house in the middle, one shelter to the left, one to the right.
Scene two_shelters(int room_left) {
    Scene scene = dry_scene(60, 40);
    scene.site.emplace();
    scene.site->houses.emplace_back().polygon = square(30, 20, 8);
    scene.site->shelters = {shelter("left", 6, 20, room_left), shelter("right", 54, 20, 0)};
    scene.crowd->navigation.every = 1;
    AgentGroup group = row_of_people(8, {10, 35}, 1, {0, 0});
    group.name = "people";
    group.goals = GoalRule::shelters;
    scene.crowd->groups = {group};
    return scene;
}

void walk(CrowdWorld& crowd, double seconds, const WaterView& water = {}) {
    for (int k = 0; k < static_cast<int>(seconds / crowd.dt) && !crowd.active.empty(); ++k) step(crowd, water);
}

// Particles of 0.25 m, or one layer of smaller ones, over a rectangle.
MadeUpWater pond(double x_lo, double x_hi, double z_lo, double z_hi, double depth, double speed) {
    return uniform_water(x_lo, x_hi, z_lo, z_hi, depth, std::min(depth, 0.25), speed, 0);
}

TEST_CASE("Tobler's speed is 1 on level ground, largest 5 % downhill, and halves on 0.15 uphill") {
    CHECK(tobler(0) == 1);
    CHECK(tobler(-0.05) == Approx(std::exp(0.175)));
    CHECK(tobler(0.15) == Approx(std::exp(-3.5 * 0.15)));
}

TEST_CASE("Routes see the same depth with cells of the fluid of any size, beside houses too") {
    CrowdWorld crowd = make_crowd(two_shelters(0));
    SiteRoutes& site = *crowd.navigation.site;
    const double cell = GENERATE(0.3, 0.5, 0.89, 1.34, 2.0, 4.0), depth = 0.5, speed = 1.5;
    const double dx = 60 / std::round(60 / cell), dz = 40 / std::round(40 / cell);
    WaterBins water = empty_bins(crowd.scene);
    water.column = {dx, dz};
    for (double x = 0.5 * dx; x < 60; x += dx) {
        for (double z = 0.5 * dz; z < 40; z += dz) {
            if (std::abs(x - 30) + 0.5 * dx <= 8 && std::abs(z - 20) + 0.5 * dz <= 8) continue;
            water.x.push_back(x);
            water.z.push_back(z);
            water.mass.push_back(static_cast<float>(1000 * depth * dx * dz));
            water.vx.push_back(static_cast<float>(speed));
            water.vz.push_back(0);
        }
    }
    CHECK(find_water(site, water, 1000));
    for (std::size_t c = 0; c < site.cells.cells(); ++c) {
        if (site.free[c] == 0) continue;
        CHECK(site.depth[c] == Approx(depth).epsilon(1e-5));
        CHECK(site.speed[c] == Approx(speed).epsilon(1e-5));
    }
}

TEST_CASE("People come to the nearer shelter, and on to the next once it is full") {
    CrowdWorld crowd = make_crowd(two_shelters(0));
    walk(crowd, 40);
    CHECK(crowd.sheltered == 8);
    CHECK(crowd.navigation.site->taken == std::vector<std::size_t>{8, 0, 0});

    CrowdWorld full = make_crowd(two_shelters(3));
    walk(full, 20);
    CHECK(full.navigation.site->taken[0] == 3);
    walk(full, 100);
    CHECK(full.navigation.site->taken == std::vector<std::size_t>{3, 5, 0});
    CHECK(full.active.empty());
    for (std::size_t id = 0; id < 8; ++id) CHECK(full.agents.outcome[id] == Outcome::sheltered);
}

TEST_CASE("Water that nobody may stand in closes a way, and is gone round once it is there") {
    Scene scene = two_shelters(0);
    scene.site->houses[0].polygon = {{{{20, 14}, {40, 14}, {40, 26}, {20, 26}}}};
    scene.site->shelters = {shelter("right", 54, 10, 0)};
    scene.crowd->groups[0] = row_of_people(1, {10, 12}, 1, {0, 0});
    scene.crowd->groups[0].goals = GoalRule::shelters;
    scene.crowd->response = ResponseKind::measured;
    scene.crowd->groups[0].tau.reset();
    const auto highest = [&](const MadeUpWater& water) {
        CrowdWorld crowd = make_crowd(scene);
        double z = 0;
        for (int k = 0; k < 900 && !crowd.active.empty(); ++k) {
            step(crowd, water.view());
            z = std::max(z, crowd.agents.position[0].y());
        }
        CHECK(crowd.sheltered == 1);
        return z;
    };
    const MadeUpWater none;
    CHECK(highest(none) < 14);
    // 0.8 m at 1.5 m/s is far beyond D = 1 for all people. The pond lies below the house, so the route passes above it.
    CHECK(highest(pond(20, 40, 0, 14, 0.8, 1.5)) > 26);
    // 0.1 m of still water is walked through.
    CHECK(highest(pond(20, 40, 0, 14, 0.1, 0)) < 14);
    // People that enter at most 0.05 m walk round it.
    scene.crowd->navigation.enters_up_to = 0.05;
    CHECK(highest(pond(20, 40, 0, 14, 0.1, 0)) > 26);
}

TEST_CASE("Who is cut off waits at the water's edge, and who is caught in it comes out") {
    Scene scene = two_shelters(0);
    scene.site->houses.clear();
    scene.site->shelters = {shelter("right", 54, 20, 0)};
    scene.crowd->navigation.enters_up_to = 0.3;
    scene.crowd->groups[0] = row_of_people(1, {10, 20}, 1, {0, 0});
    scene.crowd->groups[0].goals = GoalRule::shelters;
    const MadeUpWater water = pond(30, 40, 0, 40, 0.5, 0);
    CrowdWorld crowd = make_crowd(scene);
    walk(crowd, 40, water.view());
    CHECK(crowd.agents.position[0].x() > 26);
    CHECK(crowd.agents.position[0].x() < 30);
    CHECK(is_waiting(crowd.navigation, 0));

    scene.crowd->groups[0].start_x = 36;
    CrowdWorld caught = make_crowd(scene);
    walk(caught, 60, water.view());
    CHECK(caught.sheltered == 1);
}

TEST_CASE("Who is not warned walks on until it sees the water, and then goes round") {
    Scene scene = two_shelters(0);
    scene.site->houses[0].polygon = {{{{20, 14}, {40, 14}, {40, 26}, {20, 26}}}};
    scene.site->shelters = {shelter("right", 54, 10, 0)};
    scene.crowd->groups[0] = row_of_people(1, {10, 12}, 1, {0, 0});
    scene.crowd->groups[0].goals = GoalRule::shelters;
    scene.crowd->navigation.enters_up_to = 0.1;
    scene.crowd->navigation.sight = 4;
    const MadeUpWater water = pond(30, 40, 0, 14, 0.5, 0);
    const auto farthest_below = [&](bool warned) {
        scene.crowd->groups[0].warned = warned;
        CrowdWorld crowd = make_crowd(scene);
        double x = 0;
        for (int k = 0; k < 900 && !crowd.active.empty(); ++k) {
            step(crowd, water.view());
            const Vector2d& p = crowd.agents.position[0];
            if (p.y() < 14 && p.x() < 30) x = std::max(x, p.x());
        }
        CHECK(crowd.sheltered == 1);
        return x;
    };
    CHECK(farthest_below(true) < 20);
    CHECK(farthest_below(false) > 24);  // within 4 m of the water and a cell of 2 m
}

TEST_CASE("High ground is a shelter, and slopes slow people down as Tobler says") {
    Scene scene = two_shelters(0);
    scene.site->houses.clear();
    scene.site->shelters.clear();
    scene.site->ground.slope_x = 0.1;
    scene.crowd->navigation.safe_above = 5;
    scene.crowd->navigation.slope = SlopeRule::tobler;
    scene.crowd->groups[0] = row_of_people(1, {10, 20}, 1, {0, 0});
    scene.crowd->groups[0].goals = GoalRule::shelters;
    const auto walked = [&](SlopeRule rule) {
        scene.crowd->navigation.slope = rule;
        CrowdWorld crowd = make_crowd(scene);
        walk(crowd, 20);
        return crowd.agents.position[0].x() - 10;
    };
    // The two paths meet different markers, which makes some per cent.
    CHECK(walked(SlopeRule::tobler) / walked(SlopeRule::level) == Approx(std::exp(-0.35)).epsilon(0.04));
    CrowdWorld crowd = make_crowd(scene);
    walk(crowd, 80);
    CHECK(crowd.sheltered == 1);
    CHECK(crowd.agents.position[0].x() >= 50);
}

TEST_CASE("Whom no way leads to a shelter is named") {
    Scene scene = two_shelters(0);
    scene.site->shelters = {shelter("inside", 30, 20, 0)};
    scene.site->houses[0].polygon = {
        {{{20, 10}, {40, 10}, {40, 30}, {20, 30}}, {{21, 11}, {39, 11}, {39, 29}, {21, 29}}}};
    scene.crowd->navigation.rule = NavigationRule::travel_time;
    CHECK_THROWS_WITH(make_crowd(scene),
                      Catch::Contains("agent 0 of group \"people\" starts at (10, 35) m without a way "
                                      "to any shelter, as do 7 more"));
}

TEST_CASE("A house opens to the street, not into its court, and to where a route begins") {
    const auto court_site = [] {
        Scene scene = two_shelters(0);
        House house;
        house.name = "court";
        house.residents = 4;
        house.polygon = {{{{20, 10}, {30, 10}, {30, 20}, {20, 20}}, {{22, 12}, {28, 12}, {28, 18}, {22, 18}}}};
        scene.site->houses = {house};
        scene.site->ground.points = {{0, 5, 0}, {60, 5, 0}, {60, 5, 40}, {0, 5, 40}, {25, 0, 15}};  // low in the court
        scene.crowd->groups[0].starts = StartRule::houses;
        scene.crowd->navigation.rule = NavigationRule::travel_time;
        return scene;
    };
    CrowdWorld crowd = make_crowd(court_site());
    REQUIRE(crowd.agents.size() == 4);
    const Vector2d door = crowd.agents.position[0];
    CHECK((door.x() < 20 || door.x() > 30 || door.y() < 10 || door.y() > 20));
    CHECK(crowd.warnings.empty());

    // A second house 0.6 m before the lowest wall: the door is another one, and the site is not refused.
    Scene scene = court_site();
    House second = scene.site->houses[0];
    second.polygon = {{{{20, 20.6}, {30, 20.6}, {30, 30}, {20, 30}}}};
    second.residents = 0;
    scene.site->houses.push_back(second);
    scene.site->ground.points = {{0, 5, 0}, {60, 5, 0}, {60, 5, 40}, {0, 5, 40}, {25, 0, 20.3}};
    CrowdWorld beside = make_crowd(scene);
    CHECK(beside.agents.position[0].y() < 20.25);
    CHECK(std::isfinite(beside.agents.leaves[0]));

    // Shut in on all sides: the people stay, and the warning names the house.
    scene.site->houses[1].polygon = {
        {{{18, 8}, {32, 8}, {32, 22}, {18, 22}}, {{19.5, 9.5}, {30.5, 9.5}, {30.5, 20.5}, {19.5, 20.5}}}};
    CrowdWorld shut = make_crowd(scene);
    CHECK(std::isinf(shut.agents.leaves[0]));
    REQUIRE_FALSE(shut.warnings.empty());
    CHECK_THAT(shut.warnings.back(),
               Catch::Contains("/site/houses/0: no route leads from a door to a goal, so that 4 residents"));
}

TEST_CASE("Fields that wait for the first person outdoors equal those solved at each change of the water") {
    Scene scene = two_shelters(1);
    scene.site->houses[0].residents = 4;
    scene.crowd->groups[0].starts = StartRule::houses;
    scene.crowd->response = ResponseKind::measured;
    scene.crowd->groups[0].leaving.after = 6;
    const auto run = [&](bool solves_always) {
        CrowdWorld crowd = make_crowd(scene);
        std::vector<std::vector<double>> travel;
        for (int k = 0; k < static_cast<int>(60 / crowd.dt) && crowd.sheltered < 4; ++k) {
            // A pond that grows, dries and comes back elsewhere before the first departure.
            const double t = k * crowd.dt;
            const MadeUpWater none, wide = pond(2, 20, 2, 38, 0.1 + 0.1 * std::floor(t), 1.5),
                                    far = pond(40, 58, 2, 38, 0.3, 0.5);
            step(crowd, (t < 3 ? wide : t < 4 ? none : far).view());
            if (solves_always) solve_due_fields(crowd.navigation, crowd.positions, 1);
            if (t >= 5.5) {
                for (const TravelTimeField& field : crowd.navigation.fields) travel.push_back(field.travel);
            }
        }
        return std::tuple(crowd.agents.position, crowd.sheltered, crowd.navigation.site->taken, travel);
    };
    const auto deferred = run(false), always = run(true);
    CHECK(std::get<1>(deferred) == 4);
    CHECK(std::get<0>(deferred) == std::get<0>(always));
    CHECK(std::get<2>(deferred) == std::get<2>(always));
    CHECK(std::get<3>(deferred).back() == std::get<3>(always).back());
}

TEST_CASE("With crowding the route leads to the shelter with fewer people before it") {
    Scene scene = two_shelters(0);
    AgentGroup one = scene.crowd->groups[0];
    one.columns = one.rows = one.count = 1;
    one.start_x = 29;
    // They slow 14 of the 27 m to the left by half, and the right is 2 m farther.
    AgentGroup many = row_of_people(9, {9, 16}, 1.5, {0, 0});
    many.name = "many";
    many.rows = 14, many.count = 9 * 14, many.pitch_z = 1.5;
    many.goals = GoalRule::shelters;
    many.desired_speed = 0.1;
    scene.crowd->groups = {one, many};
    const auto side = [&](double crowding, double every) {
        scene.crowd->navigation.crowding = crowding;
        scene.crowd->navigation.every = every;
        CrowdWorld crowd = make_crowd(scene);
        step(crowd, {});
        return crowd.agents.position[0].x() - 29;
    };
    CHECK(side(0, 1) < 0);
    CHECK(side(3, 1) > 0);
    CHECK(side(3, 0) > 0);
}

TEST_CASE("People go round the end of a flood wall") {
    Scene scene = dry_scene(60, 40);
    Barrier& wall = scene.site.emplace().barriers.emplace_back();
    wall.plan = {{{{29.9, 0}, {30.1, 0}, {30.1, 30}, {29.9, 30}}}};
    scene.crowd->groups = {row_of_people(1, {20, 20}, 1, {40, 20})};
    CrowdWorld crowd = make_crowd(scene);
    double highest = 0;
    for (int k = 0; k < static_cast<int>(60 / crowd.dt) && !crowd.active.empty(); ++k) {
        step(crowd, {});
        highest = std::max(highest, crowd.agents.position[0].y());
    }
    CHECK(crowd.agents.outcome[0] == Outcome::arrived);
    CHECK((highest > 30 && highest < 32));
}

TEST_CASE("A run in a site has the same bits for any number of threads") {
    const auto run = [](int threads) {
        CrowdWorld crowd = make_crowd(two_shelters(3));
        crowd.threads = threads;
        const MadeUpWater water = pond(10, 30, 0, 10, 0.4, 0.5);
        walk(crowd, 30, water.view());
        return crowd.agents.position;
    };
    CHECK(run(1) == run(3));
}

}  // namespace wade::crowd::site_routes_test
