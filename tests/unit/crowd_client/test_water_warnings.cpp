// Warnings of the resolution of the water, and what becomes of them when their remedies are followed.

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "configs/checks/scene_checks.hpp"
#include "configs/loading/scene_loader.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fields/residents.hpp"
#include "configs/scene/fluid.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/water_warnings.hpp"
#include "made_up_water.hpp"

namespace wade::crowd::water_warnings_test {

using wade::crowd::testing::one_agent_scene;
using Assignments = std::vector<std::string>;

const std::filesystem::path scenes = WADE_SCENES;

Scene loaded(const std::string& file, const Assignments& assignments) {
    std::vector<SceneOverride> overrides;
    for (const std::string& assignment : assignments) overrides.push_back(parse_override(assignment));
    Scene scene = load_scene(scenes / file, overrides).scene;
    count_lodgers(scene);
    return scene;
}

std::vector<std::string> warnings_of(const Scene& scene) {
    std::vector<std::string> warnings = water_warnings(scene);
    for (const std::string& warning : rate_warnings(scene)) warnings.push_back(warning);
    return warnings;
}

std::string key_of(const std::string& warning) {
    return warning.substr(0, warning.find(':'));
}

// The settings that a sentence names behind "Remedy: ".
Assignments remedy_of(const std::string& warning) {
    const std::size_t start = warning.find("Remedy: ");
    if (start == std::string::npos) return {};
    const std::string text = warning.substr(start);
    const std::regex setting("(/[a-z_0-9/]+) ([a-z_0-9.]*[a-z_0-9])");
    Assignments remedy;
    for (std::sregex_iterator found(text.begin(), text.end(), setting), end; found != end; ++found) {
        remedy.push_back((*found)[1].str() + "=" + (*found)[2].str());
    }
    return remedy;
}

// Follows the remedy of each warning alone: the scene is valid, and its key is not warned of. Returns the number of warnings.
std::size_t follow_remedies(const std::string& file, const Assignments& assignments) {
    const std::vector<std::string> warnings = warnings_of(loaded(file, assignments));
    for (const std::string& warning : warnings) {
        INFO(file << ": " << warning);
        const Assignments remedy = remedy_of(warning);
        REQUIRE_FALSE(remedy.empty());
        Assignments followed = assignments;
        followed.insert(followed.end(), remedy.begin(), remedy.end());
        std::vector<std::string> keys;
        for (const std::string& left : warnings_of(loaded(file, followed))) keys.push_back(key_of(left));
        CHECK(std::count(keys.begin(), keys.end(), key_of(warning)) == 0);
        // Nor is there a warning that was not there before.
        for (const std::string& key : keys) {
            INFO(key);
            CHECK(std::any_of(warnings.begin(), warnings.end(), [&](const auto& w) { return key_of(w) == key; }));
        }
    }
    return warnings.size();
}

TEST_CASE("Each remedy that a shipped scene is told of leads to a valid scene without the warning") {
    std::size_t warned = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(scenes)) {
        if (entry.path().extension() != ".json" || entry.path().parent_path() == scenes) continue;
        const std::string file = std::filesystem::relative(entry.path(), scenes).string();
        if (follow_remedies(file, {}) > 0) ++warned;
    }
    CHECK(warned >= 1);  // river/obstacle_of_people.json
}

TEST_CASE("Remedies for people of `measured` hold in other waters than the shipped ones") {
    const std::string measured = "/crowd/response=measured", kinematic = "/fluid/model=kinematic";
    struct Water {
        std::string file;
        Assignments assignments;
    };
    const std::vector<Water> waters{
        {"river/s05.json", {measured}},
        {"river/s05.json", {measured, "/frame_rate_hz=1"}},
        {"river/s05.json", {measured, "/channel/depth_m=2.2"}},
        {"river/s05.json", {measured, "/fluid/particle_spacing_m=0.9", "/fluid/max_particles=20000"}},
        {"river/s05.json", {measured, "/fluid/model=steering"}},
        {"river/s05.json", {measured, kinematic}},
        {"river/s05.json", {measured, kinematic, "/fluid/particle_spacing_m=0.9"}},
        {"river/s05.json",
         {measured, kinematic, "/fluid/kinematic/arrangement=lattice", "/fluid/kinematic/jitter=0.8"}},
        {"paper/s05.json", {measured}},
        {"models/mixed_s05.json", {measured}},
        {"sites/hamlet.json", {"/fluid/model=dfsph", "/fluid/particle_spacing_m=1"}},
        {"sites/hamlet.json", {"/fluid/shallow_water/cell_size_m=8"}},
        {"sites/village/village.json", {"/fluid/shallow_water/cell_size_m=9"}},
    };
    for (const Water& water : waters) {
        INFO(water.file << " " << water.assignments.back());
        CHECK(follow_remedies(water.file, water.assignments) >= 1);
    }
}

// The sentences about the water of a scene that hold a word, one behind the other.
std::string told_of(const std::string& word, const Scene& scene, ModelChoice choice = ModelChoice::of_scene) {
    std::string told;
    for (const std::string& warning : water_warnings(scene, choice)) {
        if (warning.find(word) != std::string::npos) told += warning;
    }
    return told;
}

Scene measured_river(ModelKind model, double spacing, double depth) {
    Scene scene = one_agent_scene(50, 20, 50, 50, 0);
    scene.crowd->response = ResponseKind::measured;
    scene.crowd->groups[0].tau.reset();
    scene.fluid->model = model;
    scene.fluid->particle_spacing = spacing;
    scene.channel->depth = depth;
    return scene;
}

TEST_CASE("A river with fewer than four layers of particles is told of with all that four layers need") {
    for (const ModelKind model : {ModelKind::dfsph, ModelKind::steering, ModelKind::mixed}) {
        const std::string told = told_of("layers", measured_river(model, 0.4642, 1));
        CHECK_THAT(told, Catch::Contains("2.15 layers") &&
                             Catch::Contains("/fluid/particle_spacing_m 0.25 or less, ") &&
                             Catch::Contains("/fluid/max_particles "));
        CHECK((told.find("/fluid/cfl 0.35") == std::string::npos) == (model == ModelKind::steering));
        CHECK(told_of("layers", measured_river(model, 0.25, 1)).empty());
        CHECK(told_of("layers", measured_river(model, 0.313, 1.25)).empty());
    }
    Scene by_tau = measured_river(ModelKind::dfsph, 0.4642, 1);
    by_tau.crowd->groups[0].tau = 0.2;
    CHECK(water_warnings(by_tau).empty());
    Scene paper = measured_river(ModelKind::dfsph, 0.4642, 1);
    paper.crowd->response = ResponseKind::paper;
    CHECK(water_warnings(paper).empty());
}

TEST_CASE("Long time steps of particle water are told of where frames do not shorten them") {
    const auto steps_told = [](double spacing, double frame_rate, double cfl, double fastest = 0.75) {
        Scene scene = measured_river(ModelKind::dfsph, spacing, 1);
        scene.frame_rate = frame_rate;
        scene.fluid->cfl = cfl;
        scene.channel->velocity = 0.75;
        if (fastest > 0.75) scene.channel->velocity_history = {{0, 0.75}, {60, fastest}, {90, 0.1}};
        return told_of("Courant", scene);
    };
    CHECK(steps_told(0.4642, 30, 0.5).empty());
    CHECK_THAT(steps_told(0.4642, 30, 0.5, 3),
               Catch::Contains("number of 0.44") && Catch::Contains("Remedy: /fluid/cfl 0.35"));
    CHECK_THAT(steps_told(0.4642, 2, 0.5),
               Catch::Contains("number of 0.5") && Catch::Contains("Remedy: /fluid/cfl 0.35"));
    CHECK_THAT(steps_told(0.25, 30, 0.5), Catch::Contains("number of 0.5"));
    CHECK(steps_told(0.4642, 2, 0.35).empty());
}

TEST_CASE("Kinematic particles that scatter in their cells are told of, rows are not") {
    const auto told = [](Arrangement arrangement, double jitter, double spacing, double depth) {
        Scene scene = measured_river(ModelKind::kinematic, spacing, depth);
        scene.fluid->kinematic.arrangement = arrangement;
        scene.fluid->kinematic.jitter = jitter;
        return told_of("fluctuates", scene);
    };
    CHECK_THAT(told(Arrangement::random, 0, 0.4642, 1),
               Catch::Contains("15 particles") && Catch::Contains("radius of 0.7 m") &&
                   Catch::Contains("Remedy: /fluid/kinematic/arrangement lattice."));
    CHECK_THAT(told(Arrangement::lattice, 0.9, 0.4642, 1), Catch::Contains("Remedy: /fluid/kinematic/jitter 0."));
    for (const double spacing : {0.25, 0.4642, 0.9}) CHECK(told(Arrangement::lattice, 0, spacing, 1).empty());
}

TEST_CASE("Water of another program is not judged by the model of the scene, that of a server is, chosen or not") {
    const auto told = [](const Scene& scene, const StreamWater& stream) {
        CrowdWorld crowd = make_crowd(scene);
        const std::size_t before = crowd.warnings.size();
        suit_to_stream(crowd, stream);
        std::string text;
        for (std::size_t k = before; k < crowd.warnings.size(); ++k) text += crowd.warnings[k];
        return text;
    };
    const Scene river = measured_river(ModelKind::dfsph, 0.4642, 1);
    StreamWater columns, server;
    columns.column = {1, 1};
    server.model = ModelKind::dfsph;
    server.spacing = 0.4642;
    CHECK(told(river, columns).empty());
    CHECK_THAT(told(river, server), Catch::Contains("2.15 layers"));
    const Scene open = measured_river(ModelKind::automatic, 0.2, 1);
    CHECK(water_warnings(open).empty());
    CHECK_THAT(told(open, server),
               Catch::Contains("2.15 layers") && Catch::Contains("Remedy: /fluid/model shallow_water."));
}

}  // namespace wade::crowd::water_warnings_test
