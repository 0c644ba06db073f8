#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/crowd_motion.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/markers/placed_houses.hpp"
#include "crowd_client/outputs/writers/report.hpp"
#include "crowd_client/results/run_summary.hpp"
#include "crowd_client/water_warnings.hpp"
#include "made_up_water.hpp"

namespace wade::crowd::residents_test {

using namespace wade::crowd::testing;

MapPolygon box(double x_lo, double x_hi, double z_lo, double z_hi) {
    return {{{{x_lo, z_lo}, {x_hi, z_lo}, {x_hi, z_hi}, {x_lo, z_hi}}}};
}

AgentGroup lodgers() {
    AgentGroup group;
    group.name = "residents";
    group.starts = StartRule::houses;
    group.goals = GoalRule::shelters;
    return group;
}

// One house with `residents` in it, a shelter 20 m away.
Scene one_house(int residents) {
    Scene scene = dry_scene(60, 40);
    scene.site.emplace();
    House& house = scene.site->houses.emplace_back();
    house.polygon = box(10, 20, 10, 20);
    house.residents = residents;
    scene.site->shelters = {{"hall", box(45, 55, 10, 20), 0}};
    scene.crowd->groups = {lodgers()};
    return scene;
}

TEST_CASE("Residents are indoors until their time, leave by their door, and come to a shelter") {
    Scene scene = one_house(5);
    scene.site->houses[0].doors = {{20, 15}};
    scene.crowd->groups[0].leaving.after = 2;
    CrowdWorld crowd = make_crowd(scene);
    CHECK(crowd.agents.size() == 5);
    CHECK(crowd.active.empty());
    CHECK(crowd.indoors.inside == 5);
    for (int k = 0; k < 20; ++k) step(crowd, {});
    CHECK(crowd.active.empty());
    CHECK_FALSE(run_is_over(crowd));
    step(crowd, {});
    // One after the other, as two have no room before a door.
    CHECK(crowd.active.size() == 1);
    CHECK(crowd.agents.position[0].x() > 20);
    for (int k = 0; k < 600 && !run_is_over(crowd); ++k) step(crowd, {});
    CHECK(crowd.sheltered == 5);
    CHECK(crowd.indoors.inside == 0);
}

TEST_CASE("Some stay, some go upstairs, and each draw is the agent's own") {
    Scene scene = one_house(2000);
    scene.site->houses[0].upper_floor = 3;
    Leaving& leaving = scene.crowd->groups[0].leaving;
    leaving.stay_share = 0.25;
    leaving.upper_floor_share = 0.5;
    leaving.rule = LeavingRule::weibull;
    leaving.scale = 100;
    const Agents agents = make_crowd(scene).agents;
    double stays = 0, up = 0, by_scale = 0;
    for (std::size_t id = 0; id < agents.size(); ++id) {
        stays += std::isinf(agents.leaves[id]) ? 1 : 0;
        up += agents.goes_up[id];
        by_scale += agents.leaves[id] <= 100 ? 1 : 0;
    }
    // Five standard deviations of 2,000 draws.
    CHECK(stays / 2000 == Approx(0.25).margin(0.05));
    CHECK(up / 2000 == Approx(0.5).margin(0.06));
    CHECK(by_scale / (2000 - stays) == Approx(1 - std::exp(-1.0)).margin(0.065));
    CrowdWorld crowd = make_crowd(scene);
    leaving.rule = LeavingRule::never;
    CHECK(make_crowd(scene).agents.people.height == crowd.agents.people.height);
}

TEST_CASE("Leaving times follow their rule") {
    Leaving table;
    table.rule = LeavingRule::table;
    table.table = {{10, 0.2}, {20, 0.6}};
    CHECK(leaving_time(table, 0.1) == 10);
    CHECK(leaving_time(table, 0.4) == Approx(15));
    CHECK(std::isinf(leaving_time(table, 0.7)));
    Leaving normal{LeavingRule::normal, 5, 30, 10, 0, 2, {}, 0, 0};
    CHECK(leaving_time(normal, 0.5) == Approx(35).margin(0.1));  // cut below 0, three deviations off
    CHECK(leaving_time(normal, 0.0) >= 5);
}

TEST_CASE("People of a table who stand in a house are indoors, others out") {
    Scene scene = one_house(0);
    std::vector<Resident> table(2);
    table[0].x = table[0].z = 15;
    table[0].leaves_at = 1;
    table[0].person.height = 1.2;
    table[1].x = 30;
    table[1].z = 30;
    scene.site->residents = std::make_shared<const std::vector<Resident>>(table);
    CrowdWorld crowd = make_crowd(scene);
    CHECK(crowd.agents.outcome[0] == Outcome::indoors);
    CHECK(crowd.agents.people.height[0] == 1.2);
    CHECK(crowd.active == std::vector<std::uint32_t>{1});
    CHECK(crowd.agents.position[1] == Vector2d(30, 30));
}

TEST_CASE("Bodies that come out of a house never overlap, and nobody of them is in its walls") {
    Scene scene = one_house(30);
    scene.crowd->bodies = BodyRule::human;
    scene.crowd->markers = MarkerRule::redrawn;
    CrowdWorld crowd = make_crowd(scene);
    for (int k = 0; k < 300; ++k) {
        step(crowd, {});
        for (const std::uint32_t a : crowd.active) {
            const Vector2d& p = crowd.agents.position[a];
            REQUIRE_FALSE(contains(scene.site->houses[0].polygon, {p.x(), p.y()}));
            for (const std::uint32_t b : crowd.active) {
                const double apart = (crowd.agents.position[b] - p).norm();
                if (b > a) REQUIRE(apart >= crowd.agents.body.radius[a] + crowd.agents.body.radius[b]);
            }
        }
    }
    CHECK(crowd.sheltered + crowd.active.size() > 15);  // one each 0.5 m at 1.3 m/s is 2.6 a second
}

TEST_CASE("People behind deep water are counted, and the deepest water at their door is kept") {
    Scene scene = one_house(3);
    scene.site->houses[0].doors = {{20, 15}};
    scene.crowd->groups[0].leaving.after = 1e6;
    CrowdWorld crowd = make_crowd(scene);
    const MadeUpWater deep = uniform_water(20, 30, 0, 40, 1.25, 0.25, 0, 0);
    step(crowd, deep.view());
    CHECK(count_behind_deep_water(crowd) == 3);
    CHECK(crowd.agents.door_depth[0] == Approx(1.25));
    for (int k = 0; k < 40; ++k) step(crowd, {});  // the water falls
    CHECK(count_behind_deep_water(crowd) == 3);
    CHECK_THAT(warning_of_deep_water(crowd), Catch::StartsWith("3 people are indoors behind 0.5 to 1.3 m of water"));
    CHECK(outcome_json(crowd, RunSummary{}, RunLabels{}).find("\"indoors_behind_deep_water\": 3") != std::string::npos);
    crowd.agents.outcome[0] = Outcome::upper_floor;
    CHECK(count_behind_deep_water(crowd) == 2);

    CrowdWorld shallow = make_crowd(scene);
    step(shallow, uniform_water(20, 30, 0, 40, 0.25, 0.25, 0, 0).view());
    CHECK(count_behind_deep_water(shallow) == 0);
    CHECK(warning_of_deep_water(shallow).empty());
}

TEST_CASE("A door into a wall is refused by its house") {
    Scene scene = one_house(1);
    scene.site->houses[0].name = "mill";
    scene.site->houses[0].doors = {{20, 15}};
    scene.site->houses.emplace_back().polygon = box(20.1, 25, 10, 20);
    CHECK_THROWS_WITH(make_crowd(scene),
                      Catch::Contains("/site/houses/0 (\"mill\"): the door at (20, 15) m opens into"));
    scene.site->houses[0].doors = {{15, 15}};
    CHECK_THROWS_WITH(make_crowd(scene), Catch::Contains("is 5 m from the walls"));
}

TEST_CASE("Fewer than three cells across the houses are told of with the cells that are enough") {
    const auto told = [](double cell, double wide, int residents) {
        Scene scene = one_house(residents);
        scene.site->houses[0].polygon = box(10, 10 + wide, 10, 28);
        scene.fluid->model = ModelKind::shallow_water;
        scene.fluid->shallow_water.cell_size = cell;
        std::string text;
        for (const std::string& warning : water_warnings(make_crowd(scene).scene)) {
            if (warning.find("across a house") != std::string::npos) text += warning;
        }
        return text;
    };
    CHECK(told(3, 9, 1).empty());
    CHECK_THAT(told(4, 9, 1), Catch::Contains("cells of 4 m, 2.2 of them") && Catch::Contains("cell_size_m 3 or less"));
    CHECK_FALSE(told(3, 6, 1).empty());
    CHECK(told(4, 9, 0).empty());
}

TEST_CASE("Fewer than three cells across the gaps between houses are told of, and houses that touch have none") {
    const auto told = [](double cell, double gap) {
        Scene scene = one_house(1);
        scene.fluid->model = ModelKind::shallow_water;
        scene.fluid->shallow_water.cell_size = cell;
        scene.site->houses[0].polygon = box(10, 20, 10, 28);
        scene.site->houses.resize(4, scene.site->houses[0]);
        scene.site->houses[1].polygon = box(20, 30, 10, 28);
        scene.site->houses[2].polygon = box(30 + gap, 40 + gap, 10, 28);
        scene.site->houses[3].polygon = box(10, 20, 28 + gap, 46);
        std::string text;
        for (const std::string& warning : water_warnings(scene)) text += warning;
        return text;
    };
    CHECK(told(1.3, 4).empty());
    CHECK_THAT(told(2.2, 3), Catch::Contains("1.4 of them across the gap to the next house") &&
                                 Catch::Contains("cell_size_m 1 or less"));
    CHECK(told(3, 9.5).empty());
}

TEST_CASE("A hundred thousand residents are made, and who is indoors costs no step") {
    Scene scene = one_house(0);
    scene.world = {.length = 1000, .width = 1000};
    scene.channel->x = scene.channel->z = {0, 1000};
    scene.crowd->markers = MarkerRule::redrawn;
    scene.crowd->navigation.cell = 5;
    scene.site->houses.clear();
    for (int k = 0; k < 1000; ++k) {
        House& house = scene.site->houses.emplace_back();
        const double x = 20 + 30 * (k % 32), z = 20 + 30 * (k / 32);
        house.polygon = box(x, x + 10, z, z + 10);
        house.residents = 100;
    }
    scene.crowd->groups[0].leaving.after = 1000;
    CrowdWorld crowd = make_crowd(scene);
    CHECK(crowd.indoors.inside == 100000);
    for (int k = 0; k < 3; ++k) step(crowd, {});
    CHECK(crowd.active.empty());
    CHECK(crowd.positions.capacity() < 100);
}

// A person that floats off in 2 m of water, 30 m from the western edge of a site.
Scene swept(bool with_outlet) {
    Scene scene = one_house(0);
    scene.fluid->shallow_water.cell_size = 1;
    scene.crowd->response = ResponseKind::measured;
    AgentGroup& group = scene.crowd->groups[0];
    group.starts = StartRule::grid;
    group.tau.reset();
    group.start_x = group.start_z = 30;
    if (with_outlet) scene.site->outlets = {{"brook", OutletKind::free, {}, {{0, 0}, {0, 40}}, {}}};
    return scene;
}

TEST_CASE("Whom the water carries into an outlet is lost, at another edge he is held") {
    const MadeUpWater water = uniform_water(0, 40, 0, 40, 2, 0.5, -2, 0);
    for (const bool with_outlet : {true, false}) {
        CrowdWorld crowd = make_crowd(swept(with_outlet));
        const int most = 250;  // steps of 0.1 s: 30 m at 2 m/s take 15 s, and the air lasts more than 25 s
        int k = 0;
        for (; k < most && crowd.agents.outcome[0] == Outcome::active; ++k) step(crowd, water.view());
        CHECK(!has_ground(crowd.agents.people.condition[0].state));
        CHECK((crowd.dead == 1) == with_outlet);
        const double x = crowd.agents.position[0].x();
        CHECK((with_outlet ? x <= 1.5 && k > 100 : x >= 0 && k == most));
    }
}

TEST_CASE("Who has a tau is lost in an outlet into which the water moves him, not in one that he walks to or past") {
    Scene scene = swept(true);
    scene.crowd->response = ResponseKind::paper;
    AgentGroup& group = scene.crowd->groups[0];
    group.start_x = 4;
    const MadeUpWater water = uniform_water(0, 40, 0, 40, 0.5, 0.5, -2, 0);
    for (const double tau : {0.0, 0.1, 0.9}) {
        group.tau = {{tau, tau}};
        CrowdWorld crowd = make_crowd(scene);
        for (int k = 0; k < 300 && crowd.agents.outcome[0] == Outcome::active; ++k) step(crowd, water.view());
        CHECK((crowd.dead == 1) == (tau == 0.9));  // with a small tau it walks on to the shelter, against the water
    }
}

TEST_CASE("Who stands in an outlet stays") {
    Scene scene = swept(true);
    scene.crowd->groups[0].start_x = 1;
    CrowdWorld crowd = make_crowd(scene);
    const MadeUpWater water = uniform_water(0, 40, 0, 40, 0.25, 0.25, -0.5, 0);
    step(crowd, water.view());
    CHECK(crowd.agents.outcome[0] == Outcome::active);
}

}  // namespace wade::crowd::residents_test
