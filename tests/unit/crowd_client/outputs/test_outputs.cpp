// Files of a run: trajectories, snapshots of the water, and what happens when they cannot be written.

#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "crowd_client/outputs/run_folder.hpp"
#include "crowd_client/session/run_client.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::one_agent_scene;
namespace fs = std::filesystem;

namespace {

class TemporaryFolder {
 public:
    TemporaryFolder() {
        std::string name = (fs::temp_directory_path() / "wade-test-XXXXXX").string();
        if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
        path = name;
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    fs::path path;
};

std::string content_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

// All rows of a query, columns separated by '|', rows by a line end.
std::string query(const fs::path& file, const std::string& sql) {
    sqlite3* db = nullptr;
    REQUIRE(sqlite3_open_v2(file.c_str(), &db, SQLITE_OPEN_READONLY, nullptr) == SQLITE_OK);
    std::string rows;
    const auto row = [](void* out, int columns, char** values, char**) {
        auto& text = *static_cast<std::string*>(out);
        for (int i = 0; i < columns; ++i) {
            if (i > 0) text += '|';
            text.append(values[i] == nullptr ? "" : values[i]);
        }
        text += '\n';
        return 0;
    };
    char* error = nullptr;
    const int code = sqlite3_exec(db, sql.c_str(), row, &rows, &error);
    INFO((error == nullptr ? "" : error));
    CHECK(code == SQLITE_OK);
    sqlite3_free(error);
    sqlite3_close(db);
    return rows;
}

std::string message_of(const std::function<void()>& call) {
    try {
        call();
    } catch (const std::exception& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("Trajectories have JuPedSim's tables, version 2, and one file remains") {
    TemporaryFolder folder;
    const fs::path file = folder.path / "trajectories.sqlite";
    Scene scene = one_agent_scene(10, 25, 75, 50, 0.2);
    scene.crowd.groups[0].count = scene.crowd.groups[0].columns = 2;
    scene.obstacles.push_back({{60, 67}, {21.5, 28.5}, 1});
    CrowdWorld crowd = make_crowd(scene);
    scene.crowd.step_rate = 45;
    TrajectoryFile trajectories(file, scene);
    trajectories.write(0, crowd.agents, crowd.active);
    crowd.active = {1};
    trajectories.write(1, crowd.agents, crowd.active);
    trajectories.close();

    CHECK(query(file, "SELECT key, value FROM metadata ORDER BY key") ==
          "fps|45\nversion|2\nxmax|100\nxmin|0\nymax|50\nymin|0\n");
    CHECK(query(file, "SELECT frame, id, pos_x, pos_y FROM trajectory_data ORDER BY frame, id") ==
          "0|0|10.0|25.0\n0|1|11.0|25.0\n1|1|11.0|25.0\n");
    CHECK(query(file, "SELECT count(*) FROM trajectory_data WHERE abs(ori_x*ori_x + ori_y*ori_y - 1) > 1e-9") == "0\n");
    CHECK(query(file, "SELECT frame FROM frame_data f JOIN geometry g ON f.geometry_hash = g.hash ORDER BY frame") ==
          "0\n1\n");
    CHECK(query(file, "SELECT wkt FROM geometry") ==
          "POLYGON ((0 0, 100 0, 100 50, 0 50, 0 0), (60 21.5, 67 21.5, 67 28.5, 60 28.5, 60 21.5))\n");
    CHECK(query(file, "SELECT name FROM sqlite_master WHERE type = 'index' AND tbl_name = 'trajectory_data'") ==
          "frame_id_idx\n");
    CHECK(query(file, "PRAGMA journal_mode") == "delete\n");
    CHECK(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()) == 1);
}

TEST_CASE("Holes of the walkable area touch neither its edge nor one another") {
    Scene scene;
    scene.obstacles.push_back({{0, 5}, {10, 20}, 1});
    scene.obstacles.push_back({{40, 50}, {10, 20}, 1});
    scene.obstacles.push_back({{50, 60}, {10, 20}, 1});
    CHECK(walkable_area_wkt(scene) ==
          "POLYGON ((0 0, 100 0, 100 50, 0 50, 0 0), "
          "(0.001 10.001, 4.999 10.001, 4.999 19.999, 0.001 19.999, 0.001 10.001), "
          "(40.001 10.001, 49.999 10.001, 49.999 19.999, 40.001 19.999, 40.001 10.001), "
          "(50.001 10.001, 59.999 10.001, 59.999 19.999, 50.001 19.999, 50.001 10.001))");
}

TEST_CASE("When the database cannot grow, the error says so and the frames written before are whole") {
    TemporaryFolder folder;
    const fs::path file = folder.path / "trajectories.sqlite";
    Scene scene = one_agent_scene(10, 1, 75, 50, 0.2);
    scene.crowd.groups[0].columns = scene.crowd.groups[0].count = 20;
    const CrowdWorld crowd = make_crowd(scene);
    std::uint64_t frame = 0;
    std::string message;
    bool full = false;
    {
        TrajectoryFile trajectories(file, scene, 20);
        try {
            for (; frame < 100000; ++frame) trajectories.write(frame, crowd.agents, crowd.active);
        } catch (const OutputError& error) {
            message = error.what();
            full = error.disk_full();
            CHECK(error.code() == ExitCode::unexpected);
        }
    }
    CHECK(full);
    CHECK_THAT(message, Catch::Contains("no space left on the device of '" + file.string() + "'"));
    REQUIRE(frame > 10);
    CHECK(query(file, "SELECT count(*), count(DISTINCT frame), max(frame) FROM trajectory_data") ==
          std::to_string(20 * frame) + "|" + std::to_string(frame) + "|" + std::to_string(frame - 1) + "\n");
    CHECK(query(file, "PRAGMA integrity_check") == "ok\n");
}

TEST_CASE("A file is replaced as a whole, and stays as it was if the disk is full") {
    TemporaryFolder folder;
    const fs::path file = folder.path / "outcome.json";
    write_whole_file(file, "old");
    write_whole_file(file, "new");
    CHECK(content_of(file) == "new");
    CHECK_FALSE(fs::exists(file.string() + ".part"));

    fs::create_symlink("/dev/full", file.string() + ".part");
    const std::string message = message_of([&] { write_whole_file(file, "never"); });
    CHECK_THAT(message, Catch::Contains("no space left on the device of '" + file.string() + "'"));
    CHECK(content_of(file) == "new");
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
    scene.channel.x = {10, 12};
    scene.channel.z = {20, 21.5};
    scene.fluid.particle_spacing = 0.25;
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
    CrowdWorld crowd = make_crowd(scene);
    RunLabels labels;
    labels.canonical_scene = "{}";
    RunFolder run(folder.path / "deep" / "run", crowd, labels, {.water_interval = 0.5});
    CHECK_THAT(content_of(run.path() / "outcome.json"), Catch::Contains("\"status\": \"running\""));
    testing::MadeUpSource source(1000, [](std::uint64_t) { return testing::MadeUpWater{}; });
    RunSummary summary;
    ClientHooks hooks;
    hooks.on_step = [&](const CrowdWorld& c, const WaterView& water) { run.record(c, water); };
    run_client(crowd, source, summary, hooks);
    run.finish(crowd, summary, labels);
    CHECK_THAT(content_of(run.path() / "outcome.json"), Catch::Contains("\"status\": \"completed\""));
    for (const char* name : {"agents.csv", "manifest.json", "outcome.json", "trajectories.sqlite", "water.bin"}) {
        CHECK(fs::exists(run.path() / name));
    }
    CHECK(std::distance(fs::directory_iterator(run.path()), fs::directory_iterator()) == 5);
    // Rows as long as the agent was active: from frame 0 to the one before it arrived.
    CHECK(query(run.path() / "trajectories.sqlite", "SELECT max(frame) FROM trajectory_data") ==
          std::to_string(crowd.agents.end_step[0] - 1) + "\n");
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
        CHECK_THAT(crowds_csv_row(crowd, summary), Catch::Contains(",failed,1,0,0,1,,cannot write '"));
        fs::remove_all(folder.path / blocked);
    }
}

TEST_CASE("Events of a run are on the disk at once, as lines and as a scene") {
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
    const std::string scene = content_of(folder.path / "scene_as_played.json");
    CHECK(scene.find("\"frame\": 3") < scene.find("\"group\": \"walkers\""));
    CHECK(scene.find("\"group\": \"walkers\"") < scene.find("\"agent\": 0"));
}

TEST_CASE("Ragdolls and levels of danger have files of their own, if they are asked for") {
    TemporaryFolder folder;
    Scene scene = one_agent_scene(50, 25, 75, 50, 0.9);
    scene.channel.velocity = 2.5;
    scene.channel.z = {12, 38};  // whole cells of 2 m
    scene.crowd.ragdoll.condition = RagdollCondition::paper;
    scene.duration = 1;
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
    CHECK(std::count(ragdolls.begin(), ragdolls.end(), '\n') == 31);
    CHECK_THAT(ragdolls, Catch::StartsWith("frame,id,hip_height_m,rate_x_rad_s,rate_y_rad_s,rate_z_rad_s\n1,0,0.5,"));
    CHECK_THAT(content_of(folder.path / "agents.csv"),
               Catch::Contains(",mean_dv_m2_s,danger_level,none_s,low_s,moderate_s,high_s,very_high_s\n") &&
                   Catch::Contains(",very_high,0,0,0,0,1\n"));
    CHECK_THAT(content_of(folder.path / "danger.csv"), Catch::Contains(",very_high,1,2.5,2.5,0,0,0,0,1\n"));

    // A run without them in the same folder leaves none of an earlier one.
    scene.crowd.ragdoll.condition = RagdollCondition::off;
    crowd = make_crowd(scene);
    RunFolder again(folder.path, crowd, RunLabels{}, Record{});
    again.finish(crowd, summary, RunLabels{});
    CHECK_FALSE(fs::exists(folder.path / "ragdoll.csv"));
    CHECK_FALSE(fs::exists(folder.path / "danger.csv"));
}
