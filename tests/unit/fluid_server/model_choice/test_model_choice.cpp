#include <omp.h>

#include <catch2/catch.hpp>

#include "configs/errors/exit_code.hpp"
#include "fluid_server/make_model.hpp"
#include "open_scenes.hpp"

using namespace wade;
using namespace wade::fluid::model_choice;
using namespace wade::fluid::model_choice::test;
using Catch::Matchers::Contains;
using Catch::Matchers::Equals;

namespace {

std::string refusal(const std::string& text) {
    try {
        static_cast<void>(load_scene_text(text, "scene.json"));
    } catch (const ConfigurationError& error) {
        return error.what();
    }
    return "";
}

std::string with_fluid(const std::string& fluid) {
    return R"({"channel": {"x_min_m": 0, "x_max_m": 12, "z_min_m": 1, "z_max_m": 7, )" + river + R"(}, "fluid": {)" +
           fluid + "}}";
}

}  // namespace

TEST_CASE("the demand and the model auto need each other") {
    CHECK_THAT(
        refusal(with_fluid(R"("model": "auto", "max_impulse_error": 0)")),
        Equals("scene.json: /fluid/max_impulse_error: 0: the model \"auto\" is chosen by the error that is allowed; "
               "allowed: > 0 and <= 1."));
    CHECK_THAT(
        refusal(with_fluid(R"("max_impulse_error": 0.1)")),
        Equals("scene.json: /fluid/max_impulse_error: 0.1 has no effect, as /fluid/model names the model; allowed: 0, "
               "or the model \"auto\"."));
    CHECK_THAT(refusal(with_fluid(R"("model": "auto", "max_impulse_error": 2)")), Contains("/fluid/max_impulse_error"));
    CHECK(refusal(with_fluid(R"("model": "auto", "max_impulse_error": 1)")).empty());
}

TEST_CASE("an open model cannot be simulated") {
    CHECK_THROWS_WITH(fluid::make_fluid_model(scene_with(river).scene),
                      Contains("/fluid/model: \"auto\" is no model by itself"));
}

TEST_CASE("a demand that no candidate meets is refused with the smallest error that can be had and its cost") {
    const LoadedScene scene = scene_with(river, "", "0.01");
    CHECK_THROWS_AS(choose_model(scene, "open.json", false, made_up_table()), ConfigurationError);
    CHECK_THROWS_WITH(
        choose_model(scene, "open.json", false, made_up_table()),
        Contains("open.json: /fluid/max_impulse_error: 0.01 cannot be met: the smallest estimated error is "
                 "0.03, of dfsph, d = 0.2 m") &&
            Contains("times the cost of the cheapest, shallow_water") && Contains("allowed: >= 0.03."));
    CHECK_NOTHROW(choose_model(scene_with(river, "", "0.03"), "open.json", false, made_up_table()));
}

TEST_CASE("a table without a row for the water of the scene is refused") {
    CHECK_THROWS_WITH(
        choose_model(scene_with(R"("flow": "emitter", "velocity_m_s": 1)"), "open.json", false, made_up_table()),
        Contains("/fluid/model: \"auto\" has no model for this scene"));
}

TEST_CASE("the choice is the same in every run and for any number of threads, and says what and why") {
    const LoadedScene scene = scene_with(river);
    const int threads = omp_get_max_threads();
    std::vector<std::vector<std::string>> lines;
    for (const int n : {1, 2, 1}) {
        omp_set_num_threads(n);
        lines.push_back(choose_model(scene, "open.json").lines);
    }
    omp_set_num_threads(threads);
    CHECK(lines[1] == lines[0]);
    CHECK(lines[2] == lines[0]);
    std::string all;
    for (const std::string& line : lines[0]) all += line + "\n";
    CHECK_THAT(all, Contains("water of this scene: river (a river from the start on)") && Contains("<- taken") &&
                        Contains("pilot: shallow water through 10 of 10 s") && Contains("--set /fluid/model="));
}

TEST_CASE("the scout says where, when and how deep people meet water") {
    const LoadedScene scene = scene_with(river);
    const SceneWater water = water_of(scene.scene);
    const auto meeting = scout(scene, water, 1);
    REQUIRE(meeting);
    CHECK(meeting->probes == 4);
    CHECK(meeting->wet == 4);
    CHECK(meeting->depth == Approx(1).epsilon(0.01));
    CHECK(meeting->speed == Approx(1.5).epsilon(0.01));
    CHECK(meeting->until == Approx(10));
    const auto little = scout(scene, water, 1e-5);  // goes no further than its budget
    REQUIRE(little);
    CHECK(little->until < 10);
    CHECK_FALSE(scout(scene_with(river + R"(, "top": "wall", "height_m": 1)"), water, 1));
}

TEST_CASE("a pilot that contradicts the choice goes one candidate up") {
    // In water, two models do not agree to one in a million.
    const std::vector<TableRow> wrong = parse_table(header +
                                                    "river,kinematic,0.5,,,,,1e-6,1e-6,30,0.01,4.6\n"
                                                    "river,shallow_water,0.5,,,,,1e-7,1e-7,30,0.1,4.6\n");
    const ModelChoice choice = choose_model(scene_with(river, "", "1e-5"), "open.json", true, wrong);
    REQUIRE(choice.pilot);
    CHECK(choice.pilot->contradicts());
    CHECK(choice.went_up);
    CHECK(choice.chosen.settings.model == "shallow_water");
    CHECK_THAT(choice.lines.at(choice.lines.size() - 3), Contains("contradicts the choice"));
    CHECK(choice.pilot->cost <= least_pilot);
}

TEST_CASE("a pilot stays within its share") {
    const std::vector<TableRow> dear =
        parse_table(header +
                    "river,kinematic,0.5,,,,,0.1,0.1,30,0.01,4.6\n"
                    "river,dfsph,0.1,0.0005,0.001,0.5,cubic_spline,0.01,0.02,100,1,4.6\n");
    const ModelChoice choice = choose_model(scene_with(river, "", "0.2"), "open.json", true, dear);
    CHECK_FALSE(choice.pilot);
    CHECK_FALSE(choice.went_up);
    CHECK_THAT(choice.lines.at(choice.lines.size() - 3), Contains("would cost more than its share"));
}
