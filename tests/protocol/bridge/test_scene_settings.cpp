// The block "Wade" of a scene of SPlisHSPlasH, and the scene of S5 that is shipped.

#include <catch2/catch.hpp>

#include "configs/files/text_file.hpp"
#include "configs/json/json.hpp"
#include "tools/splishsplash/scene_settings.hpp"

using namespace wade::splishsplash;
using Catch::Contains;
using wade::Json;

namespace {

Json shipped_scene() {
    return Json::parse(wade::read_text_file(WADE_BRIDGE_FOLDER "/s05_river.json", "the shipped scene"));
}

}  // namespace

TEST_CASE("a scene without the block has the world's units and a session of its own") {
    const SceneSettings settings = read_settings("");
    CHECK(settings.session == "splishsplash");
    CHECK(settings.units.metres_per_unit == 1);
    CHECK(settings.units.time_scale == 1);
    CHECK(settings.units.axes == std::array<std::int32_t, 3>{1, 2, 3});
}

TEST_CASE("every key of the block is read") {
    const SceneSettings settings = read_settings(
        R"({"session": "a", "metres_per_unit": 10, "time_scale": 3.5, "origin_m": [1, 2.5, -3], "axes": [1, 3, -2],
            "depth": 2, "attach_timeout_s": 5, "step_timeout_s": 0})");
    CHECK(settings.session == "a");
    CHECK(settings.units.metres_per_unit == 10);
    CHECK(settings.units.time_scale == 3.5);
    CHECK(settings.units.origin == std::array<double, 3>{1, 2.5, -3});
    CHECK(settings.units.axes == std::array<std::int32_t, 3>{1, 3, -2});
    CHECK(settings.depth == 2);
    CHECK(settings.attach_timeout_s == 5);
    CHECK(settings.step_timeout_s == 0);
}

TEST_CASE("a wrong key or value of the block is refused with its place and its value") {
    CHECK_THROWS_WITH(read_settings(R"({"scale": 10})"), Contains("/Wade/scale is no key"));
    CHECK_THROWS_WITH(read_settings(R"({"time_scale": -1})"), Contains("/Wade/time_scale is -1"));
    CHECK_THROWS_WITH(read_settings(R"({"time_scale": "10"})"), Contains("/Wade/time_scale is \"10\""));
    CHECK_THROWS_WITH(read_settings(R"({"axes": [1, 2]})"), Contains("/Wade/axes is [1,2]"));
    CHECK_THROWS_WITH(read_settings(R"({"axes": [1, 2, 3.5]})"), Contains("three integers"));
    CHECK_THROWS_WITH(read_settings(R"({"axes": [1, 2, 2]})"), Contains("axes is [1, 2, 2]"));
    CHECK_THROWS_WITH(read_settings(R"({"depth": 64})"), Contains("/Wade/depth is 64"));
    CHECK_THROWS_WITH(read_settings(R"({"session": 5})"), Contains("/Wade/session is 5"));
    CHECK_THROWS_WITH(read_settings("[]"), Contains("/Wade must be an object"));
    CHECK_THROWS_WITH(read_settings("{"), Contains("/Wade must be an object"));
}

TEST_CASE("the shipped scene of S5 sends 30 frames of the world a second, one for each time step") {
    const Json scene = shipped_scene();
    SceneSettings settings = read_settings(scene.at("Wade").dump());
    const auto& configuration = scene.at("Configuration");
    settings.units.frame_rate = configuration.at("dataExportFPS").get<double>();
    CHECK(settings.units.frame_rate / settings.units.time_scale == Approx(30));
    CHECK(static_cast<float>(configuration.at("timeStepSize").get<double>()) ==
          1.0F / static_cast<float>(settings.units.frame_rate));
}

TEST_CASE("the shipped scene of S5 emits a river 27 m wide and 1 m deep at 1.5 m/s in the crowd's place") {
    const Json scene = shipped_scene();
    const SceneSettings settings = read_settings(scene.at("Wade").dump());
    const double m = settings.units.metres_per_unit;
    const auto& emitter = scene.at("Emitters")[0];
    const double spacing = 2 * scene.at("Configuration").at("particleRadius").get<double>() * m;
    CHECK(emitter.at("width").get<double>() * spacing == Approx(27));
    CHECK(emitter.at("height").get<double>() * spacing == Approx(1));
    CHECK(emitter.at("velocity").get<double>() * m / settings.units.time_scale == Approx(1.5));
    CHECK(-m * emitter.at("translation")[2].get<double>() == Approx(25));  // z mirrored; the river's middle
}
