// Files of a run, and what happens when they cannot be written. What every output promises is tried of each in the list.

#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>

#include "configs/scene/channel.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "crowd_client/outputs/output_list.hpp"
#include "crowd_client/outputs/run_folder.hpp"
#include "crowd_client/outputs/writers/report.hpp"
#include "crowd_client/outputs/writers/water_snapshots.hpp"
#include "crowd_client/session/run_crowds.hpp"
#include "made_up_water.hpp"
#include "outputs/conformance.hpp"
#include "outputs/run_files.hpp"

using namespace wade;
using namespace wade::crowd;
using namespace wade::crowd::testing;
namespace fs = std::filesystem;

namespace {

std::string message_of(const std::function<void()>& call) {
    try {
        call();
    } catch (const std::exception& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("A file is replaced as a whole, and stays as it was if the disk is full") {
    TemporaryFolder folder;
    const fs::path file = folder.path / "outcome.json";
    write_whole_file(file, "old");
    write_whole_file(file, "new");
    CHECK(content_of(file) == "new");
    CHECK_FALSE(fs::exists(file.string() + ".part"));

    // A limit of size stands for the full disk.
    rlimit before{};
    REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
    const rlimit nothing{0, before.rlim_max};
    const auto handler = ::signal(SIGXFSZ, SIG_IGN);
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &nothing) == 0);
    const std::string message = message_of([&] { write_whole_file(file, "never"); });
    ::setrlimit(RLIMIT_FSIZE, &before);
    ::signal(SIGXFSZ, handler);
    CHECK_THAT(message, Catch::Contains("no space left on the device of '" + file.string() + "'"));
    CHECK(content_of(file) == "new");
}

TEST_CASE("A file is written beside links and FIFOs of its name, which lead nowhere") {
    TemporaryFolder folder;
    const fs::path file = folder.path / "outcome.json", elsewhere = folder.path / "elsewhere";
    write_whole_file(elsewhere, "kept");
    fs::create_symlink(elsewhere, file.string() + ".part");
    write_whole_file(file, "first");
    REQUIRE(::mkfifo((file.string() + ".part").c_str(), 0600) == 0);
    write_whole_file(file, "second");
    CHECK(content_of(file) == "second");
    CHECK(content_of(elsewhere) == "kept");
    fs::create_symlink(elsewhere, folder.path / "grows.csv");
    AppendFile(folder.path / "grows.csv").append("row");
    CHECK(content_of(folder.path / "grows.csv") == "row");
    CHECK(content_of(elsewhere) == "kept");
}

TEST_CASE("A run folder that cannot be made is a usage error that names it") {
    TemporaryFolder folder;
    std::ofstream(folder.path / "file") << "not a folder";
    const fs::path impossible = folder.path / "file" / "run";
    const CrowdWorld crowd = make_crowd(one_agent_scene(10, 25, 75, 50, 0.2));
    try {
        RunFolder run(impossible, crowd, RunLabels{}, {.water_interval = 5});
        FAIL("the folder was made");
    } catch (const RunError& error) {
        CHECK(error.code() == ExitCode::bad_configuration);
        CHECK_THAT(error.what(),
                   Catch::Contains("'" + impossible.string() + "'") && Catch::Contains("Not a directory"));
    }
    // A folder that exists but takes no files, whoever asks.
    CHECK_THAT(message_of([&] { make_run_folder("/proc/self"); }), Catch::Contains("'/proc/self'"));
}

TEST_CASE("Snapshots hold the depth of each cell") {
    TemporaryFolder folder;
    const fs::path file = folder.path / "water.bin";
    Scene scene;
    scene.channel->x = {10, 12};
    scene.channel->z = {20, 21.5};
    scene.fluid->particle_spacing = 0.25;
    {
        WaterSnapshots snapshots(file, scene);
        testing::MadeUpWater water;
        water.add(10.1, 20.1, 62.5, 0, 0);                               // cell (0, 0): 62.5 kg on 0.25 m2 = 0.25 m
        for (int i = 0; i < 200; ++i) water.add(11.9, 21.4, 125, 0, 0);  // cell (3, 2): 100 m, more than fits
        water.add(9.9, 20.1, 62.5, 0, 0);                                // outside
        snapshots.write(30, 1.0, water.view());
        snapshots.write(60, 2.0, testing::MadeUpWater{}.view());
    }
    const std::string bytes = content_of(file);
    const std::size_t record = 16 + 2 * 4 * 3;
    REQUIRE(bytes.size() == 64 + 2 * record);
    CHECK(bytes.substr(0, 8) == "WADEWAT1");
    const auto at = [&](std::size_t offset, auto value) {
        std::memcpy(&value, bytes.data() + offset, sizeof value);
        return value;
    };
    CHECK(at(8, std::uint32_t{}) == 4);
    CHECK(at(12, std::uint32_t{}) == 3);
    CHECK(at(16, double{}) == 0.5);
    CHECK(at(24, double{}) == 10);
    CHECK(at(32, double{}) == 20);
    CHECK(at(64, std::uint64_t{}) == 30);
    CHECK(at(72, double{}) == 1.0);
    CHECK(at(80, std::uint16_t{}) == 250);
    CHECK(at(82, std::uint16_t{}) == 0);
    CHECK(at(80 + 2 * 11, std::uint16_t{}) == 65535);
    CHECK(at(64 + record, std::uint64_t{}) == 60);
}

TEST_CASE("A record that does not fit on the disk leaves the ones before it") {
    AppendFile full("/dev/full");
    CHECK_THAT(message_of([&] { full.append("x"); }), Catch::Contains("no space left on the device of '/dev/full'"));
}

TEST_CASE("A run folder is complete at the end, and says 'running' until then") {
    TemporaryFolder folder;
    Scene scene = one_agent_scene(74, 46, 75, 50, 0.2);
    scene.duration = 2;
    scene.crowd->paths.rate = scene.crowd->step_rate;
    CrowdRun one{.crowd = make_crowd(scene)};
    CrowdWorld& crowd = one.crowd;
    RunLabels labels;
    labels.canonical_scene = "{}";
    RunFolder run(folder.path / "deep" / "run", crowd, labels, {.water_interval = 0.5});
    CHECK_THAT(content_of(run.path() / "outcome.json"), Catch::Contains("\"status\": \"running\""));
    testing::MadeUpSource source(1000, [](std::uint64_t) { return testing::MadeUpWater{}; });
    RunHooks hooks;
    hooks.on_step = [&](std::size_t, const WaterView& water) { run.record(crowd, water); };
    run_crowds({&one, 1}, source, hooks);
    run.finish(crowd, one.summary, labels);
    CHECK_THAT(content_of(run.path() / "outcome.json"), Catch::Contains("\"status\": \"completed\""));
    for (const char* name : {"agents.csv", "manifest.json", "outcome.json", "trajectories.sqlite", "water.bin"}) {
        CHECK(fs::exists(run.path() / name));
    }
    std::set<std::string> of_outputs;
    for (const RegisteredOutput& output : outputs()) of_outputs.insert(output.files.begin(), output.files.end());
    for (const auto& entry : fs::directory_iterator(run.path())) {
        CAPTURE(entry.path());
        CHECK(of_outputs.contains(entry.path().filename()));  // and no temporary file
    }
    // Rows from frame 0 to the first since the agent arrived.
    CHECK(query(run.path() / "trajectories.sqlite", "SELECT max(frame) FROM trajectory_data") ==
          std::to_string(crowd.agents.end_step[0]) + "\n");
    CHECK(query(run.path() / "trajectories.sqlite", "SELECT max(frame) FROM frame_data") ==
          std::to_string(crowd.steps) + "\n");
}

TEST_CASE("A run whose files cannot all be written has failed, and those that can be say so") {
    TemporaryFolder folder;
    const CrowdWorld crowd = make_crowd(one_agent_scene(10, 25, 75, 50, 0.2));
    for (const char* blocked : {"agents.csv", "manifest.json"}) {
        RunFolder run(folder.path, crowd, RunLabels{}, Record{});
        fs::remove(folder.path / blocked);
        fs::create_directories(folder.path / blocked / "not_empty");
        RunSummary summary;
        summary.status = "completed";
        CHECK_THROWS_AS(run.finish(crowd, summary, RunLabels{}), OutputError);
        CHECK(summary.status == "failed");
        CHECK_THAT(summary.message, Catch::Contains(blocked));
        CHECK_THAT(content_of(folder.path / "outcome.json"), Catch::Contains("\"status\": \"failed\""));
        CHECK_THAT(crowds_csv_row(crowd, summary), Catch::Contains(",failed,1,0,0,1,0,0,0,,cannot write '"));
        fs::remove_all(folder.path / blocked);
    }
}

TEST_CASE("Events of a run are on the disk at once as lines, and after their step as a scene") {
    TemporaryFolder folder;
    const CrowdWorld crowd = make_crowd(one_agent_scene(10, 25, 75, 50, 0.2));
    RunLabels labels;
    labels.canonical_scene = R"({"events": [{"frame": 3, "tau": 0.5}], "name": "x"})";
    RunFolder run(folder.path, crowd, labels, Record{});
    CHECK_FALSE(fs::exists(folder.path / "events.jsonl"));
    CHECK_FALSE(fs::exists(folder.path / "scene_as_played.json"));
    run.record_event({7, std::nullopt, "walkers", 0.25});
    run.record_event({7, 0, std::nullopt, 1});
    const std::string lines = R"({"frame":7,"group":"walkers","tau":0.25})"
                              "\n"
                              R"({"agent":0,"frame":7,"tau":1.0})"
                              "\n";
    CHECK(content_of(folder.path / "events.jsonl") == lines);
    CHECK_FALSE(fs::exists(folder.path / "scene_as_played.json"));
    run.record(crowd, {});
    const std::string scene = content_of(folder.path / "scene_as_played.json");
    CHECK(scene.find("\"frame\": 3") < scene.find("\"group\": \"walkers\""));
    CHECK(scene.find("\"group\": \"walkers\"") < scene.find("\"agent\": 0"));
}

TEST_CASE("Ragdolls and levels of danger have files of their own, if they are asked for") {
    TemporaryFolder folder;
    Scene scene = one_agent_scene(50, 25, 75, 50, 0.9);
    scene.channel->velocity = 2.5;
    scene.channel->z = {12, 38};  // whole cells of 2 m
    scene.crowd->ragdoll.condition = RagdollCondition::paper;
    scene.duration = 1;
    scene.crowd->paths.rate = 10;
    CrowdWorld crowd = make_crowd(scene);
    const testing::MadeUpWater water = testing::uniform_water(30, 70, 15, 35, 1, 0.25, -2.5, 0);
    RunFolder run(folder.path, crowd, RunLabels{}, {.danger_window = 0.5});
    for (int i = 0; i < 30; ++i) {
        step(crowd, water.view());
        run.record(crowd, water.view());
    }
    RunSummary summary;
    run.finish(crowd, summary, RunLabels{});
    const std::string ragdolls = content_of(folder.path / "ragdoll.csv");
    CHECK(std::count(ragdolls.begin(), ragdolls.end(), '\n') == 1 + 8);  // but for the first 0.2 s
    CHECK_THAT(ragdolls, Catch::StartsWith("frame,id,hip_height_m,rate_x_rad_s,rate_y_rad_s,rate_z_rad_s\n3,0,0.5,"));
    CHECK_THAT(content_of(folder.path / "agents.csv"),
               Catch::Contains(",mean_dv_m2_s,state,height_m,mean_tau,worst_state,age,skill,"
                               "sex,ground_friction,bracing_arm,start_x_m,start_z_m,off_feet_s,door_depth_m,adrift_s,"
                               "exposure_s,drift_end,can_swim,"
                               "rest_s,rest_state,danger_level,"
                               "none_s,low_s,moderate_s,"
                               "high_s,very_high_s\n") &&
                   Catch::Contains(",walking,1.7,") &&
                   Catch::Contains(",,30,normal,female,0.45,0.09,50,25,,,,,,,,,very_high,0,0,0,0,1\n"));
    CHECK_THAT(content_of(folder.path / "danger.csv"), Catch::Contains(",very_high,1,2.5,2.5,0,0,0,0,1\n"));

    // A run without them in the same folder leaves none of an earlier one.
    scene.crowd->ragdoll.condition = RagdollCondition::off;
    crowd = make_crowd(scene);
    RunFolder again(folder.path, crowd, RunLabels{}, Record{});
    again.finish(crowd, summary, RunLabels{});
    CHECK_FALSE(fs::exists(folder.path / "ragdoll.csv"));
    CHECK_FALSE(fs::exists(folder.path / "danger.csv"));
}

TEST_CASE("Poses are rows of all on their way, from the start to where each ends, with those whom they hold") {
    TemporaryFolder folder;
    Scene scene = one_agent_scene(50, 25, 60, 25, 0);
    scene.fluid->particle_spacing = 0.25;
    scene.crowd->response = ResponseKind::measured;
    scene.crowd->pose_rate = 20;  // so 15: each second step
    AgentGroup& group = scene.crowd->groups[0];
    group.tau.reset();
    group.rows = group.count = 3;
    group.pitch_z = 0.7;
    group.hand_in_hand = HandInHand::along_z;
    CrowdWorld crowd = make_crowd(scene);
    RunFolder run(folder.path, crowd, RunLabels{}, Record{});
    while (!run_is_over(crowd) && crowd.steps < 600) {
        step(crowd, {});
        run.record(crowd, {});
    }
    RunSummary summary;
    run.finish(crowd, summary, RunLabels{});
    CHECK(crowd.arrived == 3);
    const std::string poses = content_of(folder.path / "poses.csv");
    CHECK_THAT(poses, Catch::StartsWith("frame,time_s,id,x_m,z_m,state,posture,heading_rad,speed_m_s,gait_phase,"
                                        "step_length_m,hip_height_m,lean_x_rad,lean_z_rad,rate_x_rad_s,rate_y_rad_s,"
                                        "rate_z_rad_s,holds\n0,0,0,50,25,walking,upright,") &&
                          Catch::Contains(",0,0,0,0.901,0,0,0,0,0,1\n0,0,1,50,25.7,walking,upright,") &&
                          Catch::Contains(",0,0,0,0.901,0,0,0,0,0,0 2\n0,0,2,50,26.4,walking,upright,") &&
                          Catch::Contains("\n1,0.067,0,50.") && Catch::EndsWith("\n"));
    // A row for each frame from 0 on, up to the first since each arrived.
    std::size_t rows = 0;
    for (const std::uint64_t end : crowd.agents.end_step) rows += (end + 1) / 2 + 1;
    CHECK(static_cast<std::size_t>(std::count(poses.begin(), poses.end(), '\n')) == 1 + rows);
    CHECK_THAT(poses, Catch::Contains(",arrived,upright,"));
}

TEST_CASE("Every output keeps what outputs promise") {
    for (const RegisteredOutput& output : outputs()) {
        INFO("output " << output.files[0]);
        check_output(output);
    }
}

TEST_CASE("No two outputs have a file in common") {
    std::set<std::string_view> names;
    std::size_t count = 0;
    for (const RegisteredOutput& output : outputs()) {
        for (const std::string_view file : output.files) {
            if (file.empty()) continue;
            names.insert(file);
            ++count;
        }
    }
    CHECK(names.size() == count);
    CHECK(names.contains("trajectories.sqlite"));
}
