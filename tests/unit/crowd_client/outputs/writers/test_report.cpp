#include <catch2/catch.hpp>
#include <sstream>

#include "configs/json/json.hpp"
#include "configs/loading/scene_loader.hpp"
#include "configs/scene/crowd.hpp"
#include "crowd_client/outputs/writers/report.hpp"
#include "crowd_client/session/run_labels.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::one_agent_scene;

namespace {

struct Finished {
    CrowdWorld crowd = make_crowd(one_agent_scene(10, 25, 75, 50, 0.2));
    RunSummary summary;
    RunLabels labels;

    Finished() {
        crowd.steps = 90;
        crowd.arrived = 1;
        crowd.active.clear();
        crowd.last_arrival_step = 90;
        crowd.agents.outcome[0] = Outcome::arrived;
        crowd.agents.end_step[0] = 90;
        summary.status = "completed";
        summary.frames = 90;
        summary.frame_hash = 0x0123456789abcdef;
        summary.agents_hash = 0xff;
        labels.model = "dfsph";
        labels.canonical_scene = R"({"name": "x"})";
        labels.command_line = {"crowd_client", "x.json"};
        labels.wall_time = 1.5;
        labels.started_at = "2026-01-01T00:00:00Z";
        labels.host = "somewhere";
    }
};

}  // namespace

TEST_CASE("outcome.json has all fields that scripts rely on") {
    Finished run;
    run.summary.fluid.particles_max = 27000;
    run.summary.fluid.steps = 200;
    run.summary.fluid.particle_steps = 5000000;
    run.summary.fluid.solver_ns = 2'500'000'000;
    run.summary.fluid.depth.add(0.9, 1);
    run.summary.fluid.density_error.add(0.0004, 200);
    run.summary.fluid.max_density_error = 0.01;
    const Json outcome = Json::parse(outcome_json(run.crowd, run.summary, run.labels));
    CHECK(outcome["scene"] == "one_agent");
    CHECK(outcome["seed"] == 1);
    CHECK(outcome["status"] == "completed");
    CHECK(outcome["frames"] == 90);
    CHECK(outcome["mode"] == "lockstep");
    CHECK(outcome["dropped_frames"] == 0);
    CHECK(outcome["frame_rate_hz"] == 30.0);
    CHECK(outcome["steps"] == 90);
    CHECK(outcome["step_rate_hz"] == 30.0);
    CHECK(outcome["sim_time_s"] == 3.0);
    CHECK(outcome["wall_time_s"] == 1.5);
    CHECK(outcome["agents"] == 1);
    CHECK(outcome["arrived"] == 1);
    CHECK(outcome["dead"] == 0);
    CHECK(outcome["active"] == 0);
    CHECK(outcome["standing"] == 0);
    CHECK(outcome["states"] == Json{{"walking", 0}, {"standing", 0}, {"arrived", 1}, {"dead", 0}});
    CHECK(outcome["warnings"] == Json::array());
    CHECK(outcome["last_arrival_s"] == 3.0);
    CHECK(outcome["contact_rule"] == "difference");
    CHECK(outcome["frame_hash"] == "0123456789abcdef");
    CHECK(outcome["agents_hash"] == "00000000000000ff");
    const Json& fluid = outcome["fluid"];
    CHECK(fluid["model"] == "dfsph");
    CHECK(fluid["particles_max"] == 27000);
    CHECK(fluid["particle_steps"] == 5000000);
    CHECK(fluid["steps"] == 200);
    CHECK(fluid["solver_wall_s"] == 2.5);
    CHECK(fluid["mean_depth_m"] == 0.9);
    CHECK(fluid["mean_speed_m_s"].is_null());
    CHECK(fluid["max_density_error"] == 0.01);
    CHECK(fluid["mean_density_error"].get<double>() == Approx(0.0004));
    CHECK(fluid["position_clamps"] == 0);
}

TEST_CASE("What a producer does not give, and what did not happen, is null") {
    Finished run;
    run.crowd.arrived = 0;
    run.summary.frame_hash = run.summary.agents_hash = 0;
    const Json outcome = Json::parse(outcome_json(run.crowd, run.summary, run.labels));
    CHECK(outcome["last_arrival_s"].is_null());
    CHECK(outcome["frame_hash"].is_null());
    CHECK(outcome["agents_hash"].is_null());
    for (const char* key : {"particle_steps", "steps", "solver_wall_s", "mean_depth_m", "mean_speed_m_s",
                            "max_density_error", "mean_density_error", "position_clamps"}) {
        CHECK(outcome["fluid"].at(key).is_null());
    }
}

TEST_CASE("Reproducible texts hold no time and no host") {
    Finished run;
    run.summary.fluid.solver_ns = 12345678;
    run.summary.fluid.resident_bytes = 87654321;
    run.labels.reproducible = true;
    const std::string first =
        outcome_json(run.crowd, run.summary, run.labels) + manifest_json(run.crowd, run.summary, run.labels);
    run.labels.wall_time = 99;
    run.labels.started_at = "another day";
    run.labels.host = "elsewhere";
    run.labels.session = "another";
    run.summary.fluid.solver_ns = 1;
    run.summary.fluid.resident_bytes = 1;
    CHECK(outcome_json(run.crowd, run.summary, run.labels) + manifest_json(run.crowd, run.summary, run.labels) ==
          first);
}

TEST_CASE("agents.csv has one line an agent with the columns that scripts rely on") {
    Finished run;
    run.crowd.scene.crowd->groups[0].name = "a, \"b\"";
    run.crowd.agents.position[0] = Vector2d(0.1, 50);
    run.crowd.agents.path_length[0] = 1.0 / 3;
    run.crowd.agents.wet_steps[0] = 2;
    run.crowd.agents.depth_sum[0] = 1.5;
    run.crowd.agents.dv_sum[0] = 1.8;
    run.crowd.agents.tau_sum[0] = 0.5;
    run.crowd.agents.lost_feet_step[0] = 30;
    std::istringstream csv(agents_csv(run.crowd));
    std::string line;
    std::getline(csv, line);
    CHECK(line ==
          "id,group,outcome,time_s,x_m,z_m,tau,mass_kg,path_length_m,max_depth_m,max_dv_m2_s,mean_depth_m,"
          "mean_dv_m2_s,state,height_m,mean_tau,worst_state,age,skill,"
          "sex,ground_friction,bracing_arm,start_x_m,start_z_m,off_feet_s,door_depth_m,adrift_s,exposure_s,drift_end,"
          "can_swim,rest_s,rest_state");
    std::getline(csv, line);
    CHECK(line ==
          "0,\"a, "
          "\"\"b\"\"\",arrived,3,0.1,50,0.2,65,0.3333333333333333,0,0,0.75,0.9,arrived,1.7,0.25,,30,normal,female,0.45,"
          "0.09,10,25,1,,,,,"
          ",,");
    CHECK_FALSE(std::getline(csv, line));
}

TEST_CASE("Who stands is counted among the active, and named in agents.csv") {
    Finished run;
    run.crowd.agents.outcome[0] = Outcome::active;
    run.crowd.active = {0};
    run.crowd.arrived = 0;
    run.crowd.agents.standing[0] = true;
    run.crowd.warnings = {"a person stands"};
    const Json outcome = Json::parse(outcome_json(run.crowd, run.summary, run.labels));
    CHECK(outcome["active"] == 1);
    CHECK(outcome["standing"] == 1);
    CHECK(outcome["states"]["standing"] == 1);
    CHECK(outcome["warnings"] == Json{"a person stands"});
    CHECK_THAT(agents_csv(run.crowd), Catch::EndsWith(",standing,1.7,0,,30,normal,female,0.45,0.09,10,25,,,,,,,,\n") &&
                                          Catch::Contains("0,walkers,active,"));
}

TEST_CASE("Times are those of the crowd's steps, whatever the rate of the frames") {
    Finished run;
    run.crowd.scene.frame_rate = 10;
    run.crowd.scene.crowd->step_rate = 45;
    const Json outcome = Json::parse(outcome_json(run.crowd, run.summary, run.labels));
    CHECK(outcome["frame_rate_hz"] == 10.0);
    CHECK(outcome["step_rate_hz"] == 45.0);
    CHECK(outcome["sim_time_s"] == 2.0);
    CHECK(outcome["last_arrival_s"] == 2.0);
    CHECK_THAT(agents_csv(run.crowd), Catch::Contains("0,walkers,arrived,2,"));
}

TEST_CASE("A run on the latest frames says so and how many it missed") {
    Finished run;
    run.labels.latest_frames = true;
    run.summary.dropped_frames = 17;
    const Json outcome = Json::parse(outcome_json(run.crowd, run.summary, run.labels));
    CHECK(outcome["mode"] == "latest");
    CHECK(outcome["dropped_frames"] == 17);
}

TEST_CASE("A reproducible command line names no places") {
    CHECK(portable_command({"/a/b/crowd_client", "x.json", "--out", "/tmp/1", "--seed=3", "--session=s", "--commands",
                            "/tmp/fifo", "--mode", "latest", "--commands=-"}) ==
          std::vector<std::string>{"crowd_client", "x.json", "--seed=3", "--mode", "latest"});
}

TEST_CASE("The time of an active agent is that of the last step") {
    Finished run;
    run.crowd.agents.outcome[0] = Outcome::active;
    run.crowd.agents.end_step[0] = 0;
    CHECK_THAT(agents_csv(run.crowd), Catch::Contains("0,walkers,active,3,"));
}

TEST_CASE("manifest.json says what made the run") {
    Finished run;
    run.crowd.scene.hash = 0xabc;
    const Json manifest = Json::parse(manifest_json(run.crowd, run.summary, run.labels));
    for (const char* key : {"git_hash", "compiler", "version", "threads", "host", "started_at"})
        CHECK(manifest.contains(key));
    CHECK(manifest["scene_hash"] == hash_text(0xabc));
    CHECK(manifest["seed"] == 1);
    CHECK(manifest["status"] == "completed");
    CHECK(manifest["command_line"] == Json::array({"crowd_client", "x.json"}));
    CHECK(manifest["resolved_scene"]["name"] == "x");
}

TEST_CASE("Each exit code has its status") {
    CHECK(status_of(1) == "failed");
    CHECK(status_of(3) == "attach_timeout");
    CHECK(status_of(4) == "peer_dead");
    CHECK(status_of(5) == "peer_aborted");
    CHECK(status_of(6) == "protocol_violation");
    CHECK(status_of(7) == "step_timeout");
    CHECK(status_of(130) == "interrupted");
    CHECK(status_of(143) == "interrupted");
}
