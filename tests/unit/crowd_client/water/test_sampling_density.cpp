#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "configs/scene/channel.hpp"
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

// One point a cell, 0.5 m deep, from an odd place on; 0.2 m/s along z.
MadeUpWater points(double cell, double depth = 0.5) {
    MadeUpWater water;
    for (double x = 40.03; x < 60; x += cell) {
        for (double z = 11.57; z < 38.5; z += cell) water.add(x, z, 1000 * depth * cell * cell, 0, 0.2);
    }
    return water;
}

// The sentences about the points of a stream after a minute, with steps in which nothing was near left out.
std::size_t warnings_of(const Scene& scene, const MadeUpWater& water, const StreamWater& stream) {
    CrowdWorld crowd = make_crowd(scene);
    suit_to_stream(crowd, stream);
    const std::size_t before = crowd.warnings.size();
    for (int k = 0; k < 600; ++k) step(crowd, water.view());
    for (std::size_t k = before; k < crowd.warnings.size(); ++k) {
        CHECK_THAT(crowd.warnings[k],
                   Catch::Contains("points lie") && Catch::Contains("Header.column_width (wade_columns)"));
    }
    return crowd.warnings.size() - before;
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

TEST_CASE("Columns, models of this project, the response paper and shallow water are not looked at") {
    StreamWater columns, model;
    columns.column = {1, 1};
    model.model = ModelKind::dfsph;
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

namespace {

// The sentences about particle water of a scene that hold a word, one behind the other.
std::string told_of(const std::string& word, const Scene& scene) {
    std::string told;
    for (const std::string& warning : make_crowd(scene).warnings) {
        if (warning.find(word) != std::string::npos) told += warning;
    }
    return told;
}

}  // namespace

TEST_CASE("A river with fewer than four layers of particles is told of with the spacing that has four") {
    const auto layers_told = [](double spacing, double depth, ResponseKind response) {
        Scene scene = wader(spacing);
        scene.crowd->response = response;
        scene.channel->depth = depth;
        return told_of("layers", scene);
    };
    CHECK_THAT(layers_told(0.4642, 1, ResponseKind::measured),
               Catch::Contains("2.15 layers") && Catch::Contains("/fluid/particle_spacing_m 0.25 or less"));
    CHECK(layers_told(0.25, 1, ResponseKind::measured).empty());
    CHECK(layers_told(0.313, 1.25, ResponseKind::measured).empty());  // as the remedy for 1.25 m rounds it
    CHECK(layers_told(0.4642, 1, ResponseKind::paper).empty());
}

TEST_CASE("Long time steps of particle water are told of where frames do not shorten them") {
    const auto steps_told = [](double spacing, double frame_rate, double cfl) {
        Scene scene = wader(spacing);
        scene.frame_rate = frame_rate;
        scene.fluid->cfl = cfl;
        scene.channel->velocity = 0.75;
        return told_of("Courant", scene);
    };
    CHECK(steps_told(0.4642, 30, 0.5).empty());
    CHECK_THAT(steps_told(0.4642, 2, 0.5),
               Catch::Contains("number of 0.5") && Catch::Contains("Remedy: /fluid/cfl 0.35"));
    CHECK_THAT(steps_told(0.25, 30, 0.5), Catch::Contains("number of 0.5"));
    CHECK(steps_told(0.4642, 2, 0.35).empty());
}
