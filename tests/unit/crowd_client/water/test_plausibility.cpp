#include <catch2/catch.hpp>
#include <limits>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/channel.hpp"
#include "crowd_client/water/plausibility.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::MadeUpWater;

namespace {

// A river of 100 x 27 x 1 m.
Scene river() {
    Scene scene = testing::one_agent_scene(10, 25, 75, 50, 0.2);
    scene.channel->velocity = 1;
    return scene;
}

MadeUpWater good_water() {
    return testing::uniform_water(0, 100, 12, 38, 1, 0.5, -1, 0);
}

// Heights too, which uniform_water() gives one value.
MadeUpWater with_heights(MadeUpWater water) {
    for (std::size_t i = 0; i < water.py.size(); ++i) water.py[i] = i % 2 == 0 ? 0.25F : 0.75F;
    return water;
}

MadeUpWater scaled(MadeUpWater water, float factor) {
    for (std::vector<float>* v : {&water.px, &water.py, &water.pz}) {
        for (float& x : *v) x *= factor;
    }
    return water;
}

std::vector<std::string> told(const Scene& scene, const MadeUpWater& water) {
    Plausibility plausibility(scene);
    const std::vector<std::string> sentences = plausibility.look(water.view(), 1, 0.1);
    CHECK(plausibility.look(water.view(), 2, 0.2).empty());  // each kind once
    return sentences;
}

void check_told(const MadeUpWater& water, const std::string& part) {
    const std::vector<std::string> sentences = told(river(), water);
    REQUIRE(sentences.size() == 1);
    CHECK_THAT(sentences[0],
               Catch::Contains(part) && Catch::Contains("the scene's water x 0 to 100, y 0 to 1, z 11.5 to 38.5 m"));
}

}  // namespace

TEST_CASE("Water in its channel is not spoken of, nor are some particles that are far away") {
    CHECK(told(river(), with_heights(good_water())).empty());
    MadeUpWater spray = with_heights(good_water());
    for (int i = 0; i < 100; ++i) spray.add(1e5, -1e5, 125, 0, 0);
    CHECK(told(river(), spray).empty());
}

TEST_CASE("Masses that are not above 0, or not finite, are a violation of the protocol") {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    for (const float mass : {0.0F, -100.0F, -0.0F, nan, infinity, -infinity}) {
        for (const std::size_t place : {std::size_t{0}, std::size_t{12345}, good_water().mass.size() - 1}) {
            MadeUpWater water = good_water();
            water.mass[place] = mass;
            Plausibility plausibility(river());
            try {
                static_cast<void>(plausibility.look(water.view(), 7, 1));
                FAIL("accepted a mass of " << mass);
            } catch (const RunError& error) {
                CHECK(error.code() == ExitCode::protocol_violation);
                CHECK_THAT(error.what(), Catch::Contains("frame 7") && Catch::Contains("above 0"));
            }
        }
    }
}

TEST_CASE("Water elsewhere is told of once, with both boxes and a guess") {
    MadeUpWater upright = with_heights(good_water());
    std::swap(upright.py, upright.pz);
    check_told(upright, "with y and z swapped they would lie in it");
    check_told(scaled(with_heights(good_water()), 1000), "taken as millimetres");
    check_told(scaled(with_heights(good_water()), 100), "taken as centimetres");
    MadeUpWater gone = with_heights(good_water());
    for (float& x : gone.px) x = 1e6F;
    check_told(gone, "the particles fill x 1e+06 to 1e+06");
}

TEST_CASE("Particles that are too heavy for the room they fill are told of once") {
    check_told(scaled(with_heights(good_water()), 0.001F), "most of the water lies outside");
    MadeUpWater heavy = with_heights(good_water());
    for (float& m : heavy.mass) m *= 50;
    check_told(heavy, "too much for where they are");
    for (float& m : heavy.mass) m = 3e38F;
    check_told(heavy, "3e+38 kg each");
}

TEST_CASE("Frames without any particle are told of after ten seconds, where there should be water") {
    Plausibility plausibility(river());
    const MadeUpWater none;
    CHECK(plausibility.look(none.view(), 300, 10).empty());
    const auto sentences = plausibility.look(none.view(), 301, 10.03);
    REQUIRE(sentences.size() == 1);
    CHECK_THAT(sentences[0], Catch::Contains("301 frames"));
    CHECK(plausibility.look(none.view(), 302, 10.06).empty());

    Scene dry = river();
    dry.channel->velocity = 0;
    Plausibility of_dry(dry);
    CHECK(of_dry.look(none.view(), 301, 10.03).empty());
    Plausibility drained(river());
    CHECK(drained.look(with_heights(good_water()).view(), 1, 0).empty());
    CHECK(drained.look(none.view(), 301, 10.03).empty());
}

TEST_CASE("A stream in units and axes of its own is looked at in those of the scene") {
    MadeUpWater water = with_heights(good_water());
    WaterView view = water.view();
    std::vector<float> millimetres = water.px;
    for (float& x : millimetres) x = 1000 * (100 - x);
    view.px = millimetres;
    view.scale_x = -0.001;
    view.origin_x = 100;
    Plausibility plausibility(river());
    CHECK(plausibility.look(view, 1, 0).empty());
}
