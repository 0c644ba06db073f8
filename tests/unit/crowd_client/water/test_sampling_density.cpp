#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/markers/counter_random.hpp"
#include "crowd_client/water/sampling_density.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::one_agent_scene;

namespace {

// A wader from z = 20 m on, with a sampling radius of 0.5 m unless the spacing says otherwise.
Scene wader(double spacing) {
    Scene scene = one_agent_scene(50, 20, 50, 50, 0);
    scene.crowd->response = ResponseKind::measured;
    scene.fluid->particle_spacing = spacing;
    return scene;
}

// One point a cell, 0.5 m deep, from an uneven position on; 0.2 m/s along z.
MadeUpWater points(double cell, double depth = 0.5) {
    MadeUpWater water;
    for (double x = 40.03; x < 60; x += cell) {
        for (double z = 11.57; z < 38.5; z += cell) water.add(x, z, 1000 * depth * cell * cell, 0, 0.2);
    }
    return water;
}

// Returns the warnings about a stream after a minute of steps; steps without water near an agent do not count.
std::vector<std::string> sentences_of(const Scene& scene, const MadeUpWater& water, const StreamWater& stream) {
    CrowdWorld crowd = make_crowd(scene);
    suit_to_stream(crowd, stream);
    const auto before = static_cast<std::ptrdiff_t>(crowd.warnings.size());
    WaterView view = water.view();
    view.column = stream.column;
    for (int k = 0; k < 600; ++k) step(crowd, view);
    return {crowd.warnings.begin() + before, crowd.warnings.end()};
}

std::size_t warnings_of(const Scene& scene, const MadeUpWater& water, const StreamWater& stream) {
    const std::vector<std::string> sentences = sentences_of(scene, water, stream);
    for (const std::string& sentence : sentences) {
        CHECK_THAT(sentence, Catch::Contains("points lie") && Catch::Contains("Header.column_width (wade_columns)"));
    }
    return sentences.size();
}

// Points dx along and dz across one another, on axes turned by an angle, 0.8 m deep.
MadeUpWater turned_points(double dx, double dz, double angle) {
    MadeUpWater water;
    const double c = std::cos(angle), s = std::sin(angle);
    for (int i = -200; i <= 200; ++i) {
        for (int k = -200; k <= 200; ++k) {
            const double x = 50.03 + c * i * dx - s * k * dz, z = 25.57 + s * i * dx + c * k * dz;
            if (40 < x && x < 60 && 11 < z && z < 39) water.add(x, z, 800 * dx * dz, 0, 0.2);
        }
    }
    return water;
}

}  // namespace

TEST_CASE("One point a cell is told of once where cells are too wide for the cone, not where they are narrow") {
    for (const double cell : {0.125, 0.25, 0.26}) {
        CAPTURE(cell);
        CHECK(warnings_of(wader(0.1), points(cell), {}) == 0);
    }
    for (const double cell : {0.5, 0.75, 1.0, 1.5, 2.0}) {
        CAPTURE(cell);
        CHECK(warnings_of(wader(0.1), points(cell), {}) == 1);
    }
}

TEST_CASE("Particles as far apart as the scene states are not told of, in rows or anywhere in their cells") {
    for (const double spacing : {0.25, 0.4642, 0.5}) {
        CAPTURE(spacing);
        CHECK(warnings_of(wader(spacing), points(spacing), {}) == 0);
        MadeUpWater anywhere = points(spacing);
        for (std::size_t k = 0; k < anywhere.px.size(); ++k) {
            anywhere.px[k] += static_cast<float>(spacing * (counter_uniform(1, 1, k) - 0.5));
            anywhere.pz[k] += static_cast<float>(spacing * (counter_uniform(1, 2, k) - 0.5));
        }
        CHECK(warnings_of(wader(spacing), anywhere, {}) == 0);
    }
    CHECK(warnings_of(wader(0.4642), points(1), {}) == 1);
}

TEST_CASE("The longer side of stretched cells counts, whatever their angle") {
    for (const double degrees : {0.0, 20.0, 45.0, 70.0, 90.0}) {
        CAPTURE(degrees);
        const double angle = degrees * 3.14159265358979 / 180;
        CHECK(warnings_of(wader(0.1), turned_points(0.25, 0.25, angle), {}) == 0);
        CHECK(warnings_of(wader(0.1), turned_points(0.125, 0.25, angle), {}) == 0);
        for (const double narrow : {0.2, 0.4}) {
            const std::vector<std::string> told = sentences_of(wader(0.1), turned_points(narrow, 1.6, angle), {});
            REQUIRE(told.size() == 1);
            CHECK_THAT(told[0], Catch::Contains("lie 1.6 m apart"));
        }
    }
}

TEST_CASE("Layers of points above one another count as one") {
    MadeUpWater layers = points(0.5, 0.2);
    for (const double shift : {0.03, -0.05, 0.06}) {
        const MadeUpWater more = points(0.5, 0.2);
        for (std::size_t k = 0; k < more.px.size(); ++k) {
            layers.add(static_cast<double>(more.px[k]) + shift, static_cast<double>(more.pz[k]) - shift,
                       static_cast<double>(more.mass[k]), 0, 0.2);
        }
    }
    CHECK(warnings_of(wader(0.1), layers, {}) == 1);
}

TEST_CASE("Columns are told of where they lie farther apart, or nearer, than the stream states their width") {
    const auto told = [](double cell_x, double cell_z, double width_x, double width_z) {
        StreamWater stream;
        stream.column = {width_x, width_z};
        const std::vector<std::string> sentences = sentences_of(wader(0.1), turned_points(cell_x, cell_z, 0), stream);
        REQUIRE(sentences.size() <= 1);
        return sentences.empty() ? "" : sentences[0];
    };
    for (const double cell : {0.1, 0.5, 1.0, 2.0}) {
        CAPTURE(cell);
        CHECK(told(cell, cell, cell, cell).empty());
        CHECK(told(cell, 0.5 * cell, cell, 0.5 * cell).empty());
    }
    CHECK_THAT(told(1, 1, 0.5, 0.5), Catch::Contains("lie 1 x 1 m apart") && Catch::Contains("4 times"));
    CHECK_THAT(told(1, 1, 2, 2), Catch::Contains("states columns of 2 x 2 m") && Catch::Contains("0.25 times"));
    CHECK_THAT(told(1, 0.5, 0.5, 1), Catch::Contains("lie 1 x 0.5 m apart"));
    CHECK_THAT(told(4, 4, 2, 2), Catch::Contains("lie 4 x 4 m or more apart"));
}

TEST_CASE("Columns, models of this project, the response paper and shallow water are not looked at") {
    StreamWater columns, model;
    columns.column = {1, 1};
    model.model = ModelKind::kinematic;
    CHECK(warnings_of(wader(0.1), points(1), columns) == 0);
    CHECK(warnings_of(wader(0.1), points(1), model) == 0);
    CHECK(warnings_of(wader(0.1), points(1, 0.15), {}) == 0);
    Scene paper = wader(0.1);
    paper.crowd->response = ResponseKind::paper;
    CHECK(warnings_of(paper, points(1), {}) == 0);
}

TEST_CASE("The allowed spacing is 0.53 of the radius, or 4/3 of that of the particles") {
    Feeling feeling;
    CHECK(SamplingDensity(feeling, 0.1).widest() == Approx(0.265));
    feeling.spread = 1.5 * 0.4642;
    CHECK(SamplingDensity(feeling, 0.4642).widest() == Approx(0.6189).margin(1e-4));
}
