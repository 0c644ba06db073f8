// Defaults, the canonical text and the hash.

#include <nlohmann/json.hpp>

#include "configs/scene/scene_schema.hpp"
#include "scene_texts.hpp"

using nlohmann::json;
using wade::LoadedScene;
using wade::Scene;
using namespace wade::test;

TEST_CASE("a scene that states only its channel has the defaults of the schema") {
    const Scene scene = load_patched("{}").scene;
    const json schema = json::parse(wade::scene_schema_text());
    const auto preset = [&schema](const std::string& path) -> json {
        std::string pointer;
        for (std::size_t i = 0; i < path.size(); ++i)
            pointer += path[i] == '/' ? std::string("/properties/") : std::string(1, path[i]);
        return schema.at(json::json_pointer(pointer + "/default"));
    };
    CHECK(scene.name == "scene");
    CHECK(scene.description == preset("/description"));
    CHECK(scene.seed == preset("/seed"));
    CHECK(scene.duration == preset("/duration_s"));
    CHECK(scene.frame_rate == preset("/frame_rate_hz"));
    CHECK(scene.stop_when_no_agent_is_active == preset("/stop_when_no_agent_is_active"));
    CHECK(scene.lockstep_depth == preset("/lockstep_depth"));
    CHECK(scene.world.length == preset("/world/length_m"));
    CHECK(scene.world.width == preset("/world/width_m"));
    CHECK(scene.world.gravity == preset("/world/gravity_m_s2"));
    CHECK((scene.channel.sides == wade::Sides::walls && preset("/channel/sides") == "walls"));
    CHECK((scene.channel.initial_river == wade::InitialRiver::dry && preset("/channel/initial_river") == "dry"));
    CHECK((scene.channel.top == wade::Top::open && preset("/channel/top") == "open"));
    CHECK(scene.channel.height == preset("/channel/height_m"));
    CHECK(scene.channel.bed_points.empty());
    CHECK(scene.channel.slope == preset("/channel/slope"));
    CHECK(scene.channel.manning_n == preset("/channel/manning_n"));
    CHECK(scene.channel.no_slip.empty());
    CHECK(scene.channel.velocity_history.empty());
    CHECK(scene.channel.depth == preset("/channel/depth_m"));
    CHECK(scene.channel.velocity == preset("/channel/velocity_m_s"));
    CHECK(scene.channel.water_blocks.empty());
    CHECK(scene.obstacles.empty());
    CHECK((scene.fluid.model == wade::ModelKind::dfsph && preset("/fluid/model") == "dfsph"));
    CHECK(scene.fluid.max_impulse_error == preset("/fluid/max_impulse_error"));
    CHECK(scene.fluid.particle_spacing == preset("/fluid/particle_spacing_m"));
    CHECK((scene.fluid.kernel == wade::KernelKind::cubic_spline && preset("/fluid/kernel") == "cubic_spline"));
    CHECK(scene.fluid.rest_density == preset("/fluid/rest_density_kg_m3"));
    CHECK(scene.fluid.kinematic_viscosity == preset("/fluid/viscosity_m2_s"));
    CHECK(scene.fluid.max_particles == preset("/fluid/max_particles"));
    CHECK(scene.fluid.cfl == preset("/fluid/cfl"));
    CHECK(scene.fluid.density_solve.tolerance == preset("/fluid/density_solve/tolerance"));
    CHECK(scene.fluid.density_solve.min_iterations == preset("/fluid/density_solve/min_iterations"));
    CHECK(scene.fluid.density_solve.max_iterations == preset("/fluid/density_solve/max_iterations"));
    CHECK(scene.fluid.divergence_solve.tolerance == preset("/fluid/divergence_solve/tolerance"));
    CHECK(scene.fluid.divergence_solve.min_iterations == preset("/fluid/divergence_solve/min_iterations"));
    CHECK(scene.fluid.divergence_solve.max_iterations == preset("/fluid/divergence_solve/max_iterations"));
    CHECK((scene.crowd.speed_rule == wade::SpeedRule::pi && preset("/crowd/speed_rule") == "pi"));
    CHECK(scene.crowd.markers_per_cell == preset("/crowd/markers_per_cell"));
    CHECK(scene.crowd.marker_min_distance == preset("/crowd/marker_min_distance_m"));
    const wade::NavigationSettings& navigation = scene.crowd.navigation;
    CHECK((navigation.rule == wade::NavigationRule::straight && preset("/crowd/navigation/rule") == "straight"));
    CHECK(navigation.cell == preset("/crowd/navigation/cell_m"));
    CHECK(navigation.crowding == preset("/crowd/navigation/crowding"));
    CHECK(navigation.every == preset("/crowd/navigation/every_s"));
    CHECK(scene.crowd.perception_radius == preset("/crowd/perception_radius_m"));
    CHECK(scene.crowd.goal_radius == preset("/crowd/goal_radius_m"));
    const wade::RagdollRule& ragdoll = scene.crowd.ragdoll;
    CHECK((ragdoll.condition == wade::RagdollCondition::off && preset("/crowd/ragdoll/condition") == "off"));
    CHECK(ragdoll.tau_min == preset("/crowd/ragdoll/tau_min"));
    CHECK(ragdoll.speed == preset("/crowd/ragdoll/speed_m_s"));
    CHECK(ragdoll.depth_speed == preset("/crowd/ragdoll/depth_speed_m2_s"));
    CHECK(ragdoll.random_sign == preset("/crowd/ragdoll/random_sign"));
    CHECK(scene.crowd.groups.empty());
    CHECK((scene.coupling.contact_rule == wade::ContactRule::difference &&
           preset("/coupling/contact_rule") == "difference"));
    CHECK((scene.coupling.rule == wade::CouplingRule::per_frame && preset("/coupling/rule") == "per_frame"));
    CHECK(scene.coupling.sampling_rate == preset("/coupling/sampling_rate_hz"));
    CHECK(scene.coupling.agent_radius == preset("/coupling/agent_radius_m"));
    CHECK(scene.coupling.particle_radius == preset("/coupling/particle_radius_m"));
    CHECK(scene.events.empty());
}

TEST_CASE("a group that states only its place and goal has the defaults of a group and of the crowd") {
    const Scene scene = load_patched(R"({"crowd": {"groups": [)" + group("a", 1, 1) + "]}}").scene;
    const wade::AgentGroup& a = scene.crowd.groups.at(0);
    CHECK((a.columns == 1 && a.rows == 1 && a.count == 1));
    CHECK((a.pitch_x == 1 && a.pitch_z == 1));
    CHECK((a.desired_speed == 1.3 && a.mass == 65 && a.tau == 0));
}

TEST_CASE("every default of the schema is a value that the schema allows") {
    // The canonical text states every default, so loading it checks them all.
    const LoadedScene loaded = load_patched(R"({"crowd": {"groups": [)" + group("a", 1, 1) + "]}}");
    const LoadedScene again = wade::load_scene_text(loaded.canonical_json, "again.json");
    CHECK(again.canonical_json == loaded.canonical_json);
    CHECK(again.scene.hash == loaded.scene.hash);
}

TEST_CASE("the defaults that come from the paper and its code keep their values", "[configs][defaults]") {
    const Scene scene = load_patched("{}").scene;
    CHECK(scene.world.gravity == 9.81);
    CHECK(scene.fluid.rest_density == 1000);
    CHECK(scene.fluid.particle_spacing == 0.4642);  // 100 kg a particle
    CHECK(scene.crowd.perception_radius == 1);      // markers within it are claimed
    CHECK(scene.crowd.ragdoll.tau_min == 0.8);
    CHECK(scene.crowd.ragdoll.speed == 2);
    CHECK(scene.crowd.ragdoll.depth_speed == 0.75);
    // Solver settings at which the suites' reports were made.
    CHECK(scene.fluid.cfl == 0.5);
    CHECK(scene.fluid.density_solve.tolerance == 5e-4);
    CHECK(scene.fluid.divergence_solve.tolerance == 1e-3);
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
