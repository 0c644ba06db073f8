// The scene files of configs/.

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "configs/checks/scene_checks.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "scene_texts.hpp"

using wade::LoadedScene;
using wade::Scene;

namespace {

const std::filesystem::path scenes = WADE_SCENES;

std::vector<std::filesystem::path> shipped_scenes() {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(scenes)) {
        if (entry.path().extension() == ".json" && entry.path().parent_path() != scenes) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

std::filesystem::path scenario(const std::string& set, int number) {
    return scenes / set / ((number < 10 ? "s0" : "s") + std::to_string(number) + ".json");
}

// Table 1 of the paper: tau in rows of three scenarios, v_F within them.
constexpr std::array<double, 4> taus{0.0, 0.2, 0.8, 1.0};
constexpr std::array<double, 3> velocities{0.5, 1.5, 2.5};

}  // namespace

TEST_CASE("every shipped scene loads, and its canonical text loads again to the same hash") {
    const auto files = shipped_scenes();
    CHECK(files.size() >= 41);
    for (const auto& file : files) {
        INFO(file);
        const LoadedScene loaded = wade::load_scene(file);
        const LoadedScene again = wade::load_scene_text(loaded.canonical_json, "again.json");
        CHECK(again.scene.hash == loaded.scene.hash);
        CHECK(again.canonical_json == loaded.canonical_json);
        CHECK(again.scene.name == loaded.scene.name);
    }
}

TEST_CASE("no shipped scene warns of a rate too low for the outcome of its people") {
    for (const auto& file : shipped_scenes()) {
        INFO(file);
        CHECK(wade::rate_warnings(wade::load_scene(file).scene).empty());
    }
}

TEST_CASE("every shipped scene with a channel states its Froude number") {
    for (const auto& file : shipped_scenes()) {
        INFO(file);
        const Scene scene = wade::load_scene(file).scene;
        if (!scene.site) CHECK_THAT(scene.description, Catch::Matchers::Contains("Froude number"));
    }
}

TEST_CASE("the scenarios have tau and v_F of Table 1 and the Froude number that they state") {
    for (const std::string set : {"paper", "river", "observed", "manning"}) {
        for (int number = 1; number <= 12; ++number) {
            const Scene scene = wade::load_scene(scenario(set, number)).scene;
            const auto row = static_cast<std::size_t>(number - 1);
            INFO(scene.name);
            CHECK(scene.name == set + (number < 10 ? "_s0" : "_s") + std::to_string(number));
            REQUIRE(scene.crowd->groups.size() == 1);
            CHECK(scene.crowd->groups[0].tau == taus[row / 3]);
            CHECK(scene.channel->velocity == velocities[row % 3]);
            char froude[16];
            std::snprintf(froude, sizeof froude, "= %.2f.",
                          scene.channel->velocity / std::sqrt(scene.world->gravity * 1.0));
            CHECK_THAT(scene.description, Catch::Matchers::EndsWith(froude));
        }
    }
}

TEST_CASE("the scenarios of a set differ in tau and v_F only") {
    for (const std::string set : {"paper", "river", "observed"}) {
        std::set<std::uint64_t> hashes;
        const auto levelled = [&set](int number) {
            return wade::load_scene(scenario(set, number), {wade::parse_override("/crowd/tau=0.5"),
                                                            wade::parse_override("/channel/velocity_m_s=1")})
                .scene.hash;
        };
        for (int number = 1; number <= 12; ++number) {
            CHECK(levelled(number) == levelled(1));
            hashes.insert(wade::load_scene(scenario(set, number)).scene.hash);
        }
        CHECK(hashes.size() == 12);
    }
}

TEST_CASE("the paper's set is the experiment as its authors ran it") {
    const Scene scene = wade::load_scene(scenario("paper", 5)).scene;
    CHECK(scene.channel->flow == wade::Flow::emitter);
    CHECK(scene.channel->initial_river == wade::InitialRiver::dry);
    CHECK(scene.world->gravity == 0.98);
    CHECK(scene.duration == 400);
    CHECK(scene.frame_rate == 30);
    CHECK(scene.coupling->contact_rule == wade::ContactRule::difference);
    CHECK(scene.channel->z.length() == 27);
    const wade::AgentGroup& group = scene.crowd->groups.at(0);
    CHECK(group.count == 50);
    CHECK(group.start_x + (group.columns - 1) * group.pitch_x == 87.5);
    CHECK(group.start_z + (group.rows - 1) * group.pitch_z == 10);
    CHECK((group.goal_x == 75 && group.goal_z == 50));
    // 0.4642 m was rounded to four digits from 0.1^(1/3) m, which gives 100 kg.
    CHECK(1000 * std::pow(scene.fluid->particle_spacing, 3) == Approx(100).epsilon(1e-3));
}

TEST_CASE("the river's set is the experiment as the paper describes it") {
    const Scene scene = wade::load_scene(scenario("river", 5)).scene;
    CHECK(scene.channel->flow == wade::Flow::recirculating);
    CHECK(scene.channel->initial_river == wade::InitialRiver::filled);
    CHECK(scene.channel->depth == 1);
    CHECK(scene.world->gravity == 9.81);
    CHECK(scene.crowd->groups.at(0).count == 50);
    CHECK(wade::particles_needed(scene) == wade::river_particles(scene));
}

TEST_CASE("the set on a slope has in each scenario the slope with which a river of its depth runs at v_F") {
    for (int number = 1; number <= 12; ++number) {
        const Scene scene = wade::load_scene(scenario("manning", number)).scene;
        INFO(scene.name);
        CHECK(scene.channel->flow == wade::Flow::periodic);
        CHECK(scene.channel->depth == 1);
        // Manning's formula: v = h^(2/3) S^(1/2) / n.
        CHECK(std::sqrt(scene.channel->slope) / scene.channel->manning_n ==
              Approx(scene.channel->velocity).epsilon(1e-6));
        CHECK(wade::particles_needed(scene) <= static_cast<std::uint64_t>(scene.fluid->max_particles));
    }
}

TEST_CASE("the observed set is a given stream that is transported faster than it pushes") {
    const Scene scene = wade::load_scene(scenario("observed", 5)).scene;
    CHECK(scene.fluid->model == wade::ModelKind::kinematic);
    CHECK(scene.fluid->kinematic.profile == wade::VelocityProfile::uniform);
    CHECK(scene.fluid->kinematic.transport_factor == 2.6);
    CHECK(scene.fluid->kinematic.arrangement == wade::Arrangement::lattice);
    CHECK(scene.fluid->kinematic.jitter == 0.5);
    CHECK(scene.channel->flow == wade::Flow::emitter);
    CHECK(scene.channel->initial_river == wade::InitialRiver::dry);
    CHECK(scene.channel->depth == 1);
    const Scene paper = wade::load_scene(scenario("paper", 5)).scene;
    CHECK(scene.crowd->groups.at(0).goal_x == paper.crowd->groups.at(0).goal_x);
    CHECK(scene.fluid->particle_spacing == paper.fluid->particle_spacing);
}

TEST_CASE("the paper's other scenarios are what its text says") {
    const auto of_set = [](const std::string& set, const std::string& name) {
        return wade::load_scene(scenes / set / (name + ".json")).scene;
    };
    for (const std::string set : {"paper", "river", "observed"}) {
        INFO(set);
        const Scene two = of_set(set, "two_groups");
        REQUIRE(two.crowd->groups.size() == 2);
        CHECK((two.crowd->groups[0].count == 50 && two.crowd->groups[1].count == 50));
        CHECK((two.crowd->groups[0].tau == 0.6 && two.crowd->groups[1].tau == 0.6));
        CHECK(
            (two.channel->velocity == 1.5 && two.crowd->groups[1].start_x == 0 && two.crowd->groups[1].goal_x == 100));
        const Scene change = of_set(set, "tau_switch");
        REQUIRE(change.events.size() == 1);
        CHECK((change.events[0].frame == 870 && change.events[0].tau == 0));
        CHECK((change.crowd->groups[0].tau == 0.8 && change.channel->velocity == 2.5));
        // Ten times the particles of 100 kg.
        CHECK(1000 * std::pow(of_set(set, "fine").fluid->particle_spacing, 3) == Approx(10).epsilon(1e-3));
        CHECK(of_set(set, "no_obstacle").crowd->groups[0].count == 52);
    }
    for (const std::string set : {"paper", "river"}) {
        const Scene with = of_set(set, "obstacle");
        const Scene without = of_set(set, "no_obstacle");
        REQUIRE(with.obstacles.size() == 1);
        CHECK((with.obstacles[0].x.length() == 7 && with.obstacles[0].z.length() == 7));
        CHECK(with.obstacles[0].height == 1);
        CHECK(without.obstacles.empty());
        CHECK(with.crowd->groups[0].start_x == without.crowd->groups[0].start_x);
        CHECK((with.crowd->groups[0].tau == 0.6 && with.channel->velocity == 1.5));
    }
}

TEST_CASE("the validation scenes have the layers that their references assume") {
    const Scene column = wade::load_scene(scenes / "validation/column.json").scene;
    CHECK(wade::particles_needed(column) == 10 * 10 * 10);
    const Scene dam = wade::load_scene(scenes / "validation/dam_break.json").scene;
    CHECK(wade::particles_needed(dam) == 200 * 20 * 6);
    const double c = std::sqrt(dam.world->gravity * 1.0);
    CHECK(dam.duration * c >= 8);                                       // t sqrt(g/H) up to 8
    CHECK(c * dam.duration < dam.channel->water_blocks[0].x.length());  // the rarefaction stays in the reservoir
    CHECK(2 * c * dam.duration < dam.channel->water_blocks[0].x.lo);    // the front stays on the bed
}
