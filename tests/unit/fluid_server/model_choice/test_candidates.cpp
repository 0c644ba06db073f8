#include <catch2/catch.hpp>
#include <set>
#include <stdexcept>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/fluid.hpp"
#include "open_scenes.hpp"

using namespace wade;
using namespace wade::fluid::model_choice;
using namespace wade::fluid::model_choice::test;
using Catch::Matchers::Contains;

namespace {

const std::string obstacle =
    R"(, "obstacles": [{"x_min_m": 3.5, "x_max_m": 5, "z_min_m": 5, "z_max_m": 6.5, "height_m": 2}])";

std::vector<Candidate> front_for(const LoadedScene& scene) {
    return front_of(candidates_of(made_up_table(), scene, water_of(scene.scene)));
}

}  // namespace

TEST_CASE("a table that cannot be read is refused with the line") {
    CHECK_THROWS_WITH(parse_table("kind\n"), Contains("line 1"));
    CHECK_THROWS_WITH(parse_table(header + "sea,dfsph,1,,,,,0,0,1,1,1\n"),
                      Contains("line 2: 'sea' is no kind of water"));
    CHECK_THROWS_WITH(parse_table(header + "river,dfsph,x,,,,,0,0,1,1,1\n"), Contains("'x' is not a number"));
    CHECK_THROWS_WITH(parse_table(header + "river,dfsph,1\n"), Contains("3 values, expected 12"));
}

TEST_CASE("the measured table has dfsph and shallow water for each kind of water") {
    std::set<std::pair<WaterKind, std::string>> seen;
    for (const TableRow& row : measured_table()) {
        seen.insert({row.kind, row.settings.model});
        CHECK(row.impulse_median > 0);
        CHECK(row.particle_step_cost > 0);
    }
    for (std::size_t k = 0; k < water_kinds; ++k) {
        CHECK(seen.contains({static_cast<WaterKind>(k), "dfsph"}));
        CHECK(seen.contains({static_cast<WaterKind>(k), "shallow_water"}));
    }
}

TEST_CASE("candidates are sorted by cost, each more exact than the one before") {
    const std::vector<Candidate> front = front_for(scene_with(river));
    REQUIRE(front.size() == 3);
    CHECK(front[0].settings.model == "shallow_water");
    CHECK(front[0].median == Approx(0.3));
    CHECK(front[1].median == Approx(0.09));
    CHECK(front[2].median == Approx(0.03));
    for (std::size_t k = 1; k < front.size(); ++k) CHECK(front[k].cost > front[k - 1].cost);
    CHECK(choose(front, 0.3) == 0);
    CHECK(choose(front, 0.1) == 1);
    CHECK(choose(front, 0.05) == 2);
    CHECK_FALSE(choose(front, 0.01));
}

TEST_CASE("a scene of two kinds of water takes the worse error") {
    const std::vector<Candidate> front = front_for(scene_with(river, obstacle));
    REQUIRE(front.size() == 3);
    CHECK(front[0].median == Approx(0.9));
    CHECK(front[1].median == Approx(0.15));
    CHECK(front[1].worst == WaterKind::lee);
}

TEST_CASE("spacings of the table are scaled by the depth, and the scene's own spacing stays a candidate") {
    const std::string shallow =
        R"("flow": "recirculating", "initial_river": "filled", "depth_m": 0.5, "velocity_m_s": 1)";
    const auto has = [&](const std::vector<Candidate>& list, double spacing, double median) {
        return std::any_of(list.begin(), list.end(), [&](const Candidate& c) {
            return c.settings.model == "dfsph" && c.spacing == Approx(spacing) && c.median == Approx(median);
        });
    };
    const LoadedScene scene = load_scene_text(scene_with(shallow).canonical_json, "open.json",
                                              {parse_override("/fluid/particle_spacing_m=0.15")});
    const std::vector<Candidate> all = candidates_of(made_up_table(), scene, water_of(scene.scene));
    CHECK(has(all, 0.2, 0.09));
    CHECK(has(all, 0.1, 0.03));
    CHECK(has(all, 0.15, 0.09));  // with the error of the next coarser row
}

TEST_CASE("a model without a row for a kind of water is no candidate, nor is one that cannot run the scene") {
    std::vector<TableRow> table = made_up_table();
    table.erase(table.begin());  // shallow water in a river
    const LoadedScene scene = scene_with(river);
    for (const Candidate& c : candidates_of(table, scene, water_of(scene.scene))) CHECK(c.settings.model == "dfsph");

    const LoadedScene lid = scene_with(river + R"(, "top": "wall", "height_m": 1)");
    const std::vector<Candidate> all = candidates_of(made_up_table(), lid, water_of(lid.scene));
    CHECK(all.back().settings.model == "shallow_water");
    CHECK_THAT(all.back().refused, Contains("has a free surface"));
    CHECK(front_of(all).front().settings.model == "dfsph");
}

TEST_CASE("the scene as chosen needs no choice and is known to the crowd by the hash of the scene as written") {
    const LoadedScene written = scene_with(river);
    const LoadedScene chosen = scene_as(written, front_for(written)[1]);
    CHECK(chosen.scene.fluid->model == wade::ModelKind::dfsph);
    CHECK(chosen.scene.fluid->particle_spacing == 0.4);
    CHECK(chosen.scene.hash == written.scene.hash);
    const LoadedScene again = load_scene_text(chosen.canonical_json, "chosen.json");
    CHECK(again.canonical_json == chosen.canonical_json);
    CHECK(again.scene.hash != written.scene.hash);
}
