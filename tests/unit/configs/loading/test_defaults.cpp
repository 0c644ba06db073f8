// Defaults, the canonical text and the hash.

#include "configs/json/json.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/scene_json.hpp"
#include "configs/scene/world.hpp"
#include "scene_texts.hpp"

using wade::Json;
using wade::LoadedScene;
using wade::Scene;
using namespace wade::test;

TEST_CASE("a scene that states only its channel holds otherwise what a new scene holds") {
    const LoadedScene loaded = load_patched("{}");
    Scene fresh;
    fresh.name = "scene";
    fresh.channel->x = loaded.scene.channel->x;
    fresh.channel->z = loaded.scene.channel->z;
    fresh.channel->flow = wade::Flow::closed;
    CHECK(wade::written_scene(fresh) == Json::parse(loaded.canonical_json));
}

TEST_CASE("a group that states only its place and goal has the defaults of a group and of the crowd") {
    const Scene scene = load_patched(R"({"crowd": {"groups": [)" + group("a", 1, 1) + "]}}").scene;
    const wade::AgentGroup& a = scene.crowd->groups.at(0);
    CHECK((a.columns == 1 && a.rows == 1 && a.count == 1));
    CHECK((a.pitch_x == 1 && a.pitch_z == 1));
    CHECK((a.desired_speed == 1.3 && a.mass == 65 && a.tau == 0));
}

TEST_CASE("every default is a value that its key allows") {
    // The canonical text states every default, so loading it checks them all.
    const LoadedScene loaded = load_patched(R"({"crowd": {"groups": [)" + group("a", 1, 1) + "]}}");
    const LoadedScene again = wade::load_scene_text(loaded.canonical_json, "again.json");
    CHECK(again.canonical_json == loaded.canonical_json);
    CHECK(again.scene.hash == loaded.scene.hash);
}

TEST_CASE("the defaults that come from the paper and its code keep their values", "[configs][defaults]") {
    const Scene scene = load_patched("{}").scene;
    CHECK(scene.world->gravity == 9.81);
    CHECK(scene.fluid->rest_density == 1000);
    CHECK(scene.fluid->particle_spacing == 0.4642);  // 100 kg a particle
    CHECK(scene.crowd->perception_radius == 1);      // markers within it are claimed
    CHECK(scene.crowd->ragdoll.tau_min == 0.8);
    CHECK(scene.crowd->ragdoll.speed == 2);
    CHECK(scene.crowd->ragdoll.depth_speed == 0.75);
    // Solver settings of the suites' reports.
    CHECK(scene.fluid->cfl == 0.5);
    CHECK(scene.fluid->density_solve.tolerance == 5e-4);
    CHECK(scene.fluid->divergence_solve.tolerance == 1e-3);
}

TEST_CASE("the hash does not depend on how a scene is written") {
    const auto hash = load_patched(R"({"duration_s": 5, "seed": 3})").scene.hash;
    CHECK(load_patched(R"({"seed": 3, "duration_s": 5.0})").scene.hash == hash);
    CHECK(load_patched(R"({"seed": 3e0, "duration_s": 0.5e1, "world": {}})").scene.hash == hash);
    CHECK(load_patched(R"({"seed": 3, "duration_s": 5, "fluid": {"cfl": 0.5}, "channel": {"x_min_m": -0.0}})")
              .scene.hash == hash);
    CHECK(load_patched(R"({"seed": 3, "duration_s": 5, "name": "other", "description": "other"})").scene.hash == hash);
}

TEST_CASE("the hash depends on every value") {
    const auto hash = load_patched("{}").scene.hash;
    CHECK(load_patched("{}", {"/seed=2"}).scene.hash != hash);
    CHECK(load_patched("{}", {"/fluid/cfl=0.41"}).scene.hash != hash);
    CHECK(load_patched("{}", {"/coupling/contact_rule=sum"}).scene.hash != hash);
}

TEST_CASE("hashes are shown as 16 hexadecimal digits") {
    CHECK(wade::hash_text(0x1fu) == "000000000000001f");
    CHECK(wade::hash_text(0xfedcba9876543210u) == "fedcba9876543210");
}
