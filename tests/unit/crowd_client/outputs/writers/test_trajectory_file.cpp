// trajectories.sqlite, and what other programs may do to it during a run.

#include <sys/resource.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <csignal>
#include <cstdio>
#include <thread>
#include <vector>

#include "configs/scene/crowd.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/outputs/run_folder.hpp"
#include "crowd_client/outputs/writers/trajectory_file.hpp"
#include "crowd_client/results/output_file.hpp"
#include "made_up_water.hpp"
#include "outputs/run_files.hpp"

using namespace wade;
using namespace wade::crowd;
using namespace wade::crowd::testing;
namespace fs = std::filesystem;

namespace {

Scene at_every_step(Scene scene) {
    scene.crowd->paths.rate = scene.crowd->step_rate;
    return scene;
}

// A file that is written frame by frame, and what others find in it.
struct Log {
    TemporaryFolder folder;
    fs::path file = folder.path / "trajectories.sqlite";
    fs::path rest = folder.path / "trajectories.rest.sqlite";
    Scene scene = at_every_step(one_agent_scene(10, 25, 75, 50, 0.2));
    CrowdWorld crowd = make_crowd(scene);
    std::vector<std::string> warnings;
    std::unique_ptr<TrajectoryFile> trajectories;
    std::uint64_t frame = 0;

    explicit Log(const TrajectoryLimits& limits = {}) {
        trajectories = std::make_unique<TrajectoryFile>(file, scene, limits,
                                                        [this](const std::string& text) { warnings.push_back(text); });
    }
    void write(int frames) {
        for (int i = 0; i < frames; ++i) trajectories->write(frame++, crowd.agents);
    }
    [[nodiscard]] static std::string frames_in(const fs::path& where) {
        return query(where, "SELECT count(*), min(frame), max(frame) FROM trajectory_data");
    }
};

const TrajectoryLimits impatient{.pages = 0, .kept_rows = std::size_t{1} << 20, .patience = 0.01};

}  // namespace

TEST_CASE("A query that is left open costs a run nothing but the fold of its log") {
    Log log;
    log.write(10);
    {
        Reader reader(log.file);
        reader.leave_open("SELECT frame FROM trajectory_data");
        log.write(10);
        log.trajectories->close();
        REQUIRE(log.warnings.size() == 1);
        CHECK_THAT(log.warnings[0],
                   Catch::Contains("has '" + log.file.string() + "' open") && Catch::Contains("-wal'"));
        CHECK(Log::frames_in(log.file) == "20|0|19\n");
    }
    CHECK(Log::frames_in(log.file) == "20|0|19\n");
    CHECK_FALSE(fs::exists(log.rest));
}

TEST_CASE("A reader that has the file open all the time, and counts now and then, sees whole frames and hurts nobody") {
    Log log;
    log.write(5);
    Reader reader(log.file);
    for (int i = 1; i <= 10; ++i) {
        log.write(5);
        CHECK(reader.query("SELECT count(*) FROM trajectory_data") == std::to_string(5 + 5 * i) + "\n");
    }
    log.trajectories->close();
    CHECK(Log::frames_in(log.file) == "55|0|54\n");
}

TEST_CASE("Frames that are written at once come in whole groups, and the rest of them at the end") {
    Log log({.frames_at_once = 4});
    log.write(11);
    CHECK(Log::frames_in(log.file) == "8|0|7\n");
    log.trajectories->close();
    CHECK(Log::frames_in(log.file) == "11|0|10\n");
    CHECK(log.warnings.empty());
    CHECK_FALSE(fs::exists(log.rest));
}

TEST_CASE("Frames of the time in which another program has the file locked are written afterwards") {
    for (const char* lock : {"BEGIN IMMEDIATE", "BEGIN EXCLUSIVE"}) {
        Log log;
        log.write(3);
        {
            Reader writer(log.file, SQLITE_OPEN_READWRITE);
            writer.query(lock);
            log.write(4);
            CHECK(Log::frames_in(log.file) == "3|0|2\n");
            writer.query("ROLLBACK");
        }
        log.write(1);
        CHECK(Log::frames_in(log.file) == "8|0|7\n");
        log.trajectories->close();
        CHECK(log.warnings.empty());
        CHECK(query(log.file, "SELECT group_concat(frame) FROM frame_data") == "0,1,2,3,4,5,6,7\n");
        CHECK(files_in(log.folder.path).size() == 1);
    }
}

TEST_CASE("A lock that is given up while the run ends keeps no frame out") {
    Log log;
    log.write(3);
    Reader writer(log.file, SQLITE_OPEN_READWRITE);
    writer.query("BEGIN IMMEDIATE");
    log.write(3);
    std::atomic<bool> closing = false;
    std::thread other([&] {
        while (!closing) std::this_thread::yield();
        sqlite3_exec(writer.handle, "ROLLBACK", nullptr, nullptr, nullptr);
    });
    closing = true;
    log.trajectories->close();
    other.join();
    CHECK(Log::frames_in(log.file) == "6|0|5\n");
    CHECK_FALSE(fs::exists(log.rest));
}

TEST_CASE("A lock for ever leaves the frames of its time in a file beside, with a warning that says so") {
    Log log(impatient);
    log.write(3);
    Reader writer(log.file, SQLITE_OPEN_READWRITE);
    writer.query("BEGIN IMMEDIATE");
    log.write(4);
    log.trajectories->close();
    CHECK(Log::frames_in(log.file) == "3|0|2\n");
    CHECK(Log::frames_in(log.rest) == "4|3|6\n");
    CHECK(query(log.rest, "SELECT value FROM metadata WHERE key = 'fps'") == "30\n");
    REQUIRE(log.warnings.size() == 2);
    CHECK_THAT(log.warnings[1], Catch::Contains("kept locked '" + log.file.string()) &&
                                    Catch::Contains("frames 3 to 6") && Catch::Contains(log.rest.string()));
}

TEST_CASE("What is kept of a locked file is bounded") {
    TrajectoryLimits small = impatient;
    small.kept_rows = 20;  // a frame and its one agent count two
    Log log(small);
    {
        Reader writer(log.file, SQLITE_OPEN_READWRITE);
        writer.query("BEGIN IMMEDIATE");
        log.write(35);
        CHECK(Log::frames_in(log.rest) == "33|0|32\n");
        writer.query("ROLLBACK");
    }
    log.write(5);
    log.trajectories->close();
    CHECK(Log::frames_in(log.file) == "7|33|39\n");
    CHECK(Log::frames_in(log.rest) == "33|0|32\n");
    CHECK(log.warnings.size() == 1);
}

TEST_CASE("A file that is deleted or moved away in a run is not missed by the run") {
    for (const bool moved : {false, true}) {
        Log log;
        log.write(3);
        if (moved) {
            fs::rename(log.file, log.folder.path / "elsewhere.sqlite");
        } else {
            fs::remove(log.file);
        }
        log.write(4);
        log.trajectories->close();
        CHECK(Log::frames_in(log.rest) == "4|3|6\n");
        REQUIRE(log.warnings.size() == 1);
        CHECK_THAT(log.warnings[0], Catch::Contains("moved or deleted '" + log.file.string()));
        CHECK_FALSE(fs::exists(log.file));
    }
}

TEST_CASE("A file that is made read-only, or replaced by another one, in a run ends it well") {
    Log log;
    log.write(3);
    fs::permissions(log.file, fs::perms::owner_read);
    log.write(4);
    log.trajectories->close();
    CHECK(Log::frames_in(log.file) == "7|0|6\n");

    Log replaced;
    replaced.write(3);
    fs::remove(replaced.file);
    std::ofstream(replaced.file) << "mine";
    replaced.write(4);
    replaced.trajectories->close();
    CHECK(content_of(replaced.file) == "mine");
    CHECK(Log::frames_in(replaced.rest) == "4|3|6\n");
}

TEST_CASE("What an earlier run left is gone, with its log and its rest, whoever still reads it") {
    TemporaryFolder folder;
    const fs::path file = folder.path / "trajectories.sqlite";
    const Scene scene = one_agent_scene(10, 25, 75, 50, 0.2);
    const CrowdWorld crowd = make_crowd(scene);
    auto earlier = std::make_unique<TrajectoryFile>(file, scene);
    earlier->write(0, crowd.agents);
    Reader reader(file);
    reader.leave_open("SELECT frame FROM trajectory_data");
    earlier->write(1, crowd.agents);
    earlier->close();
    REQUIRE(fs::exists(file.string() + "-wal"));
    std::ofstream(folder.path / "trajectories.rest.sqlite") << "old";

    TrajectoryFile now(file, scene);
    now.write(0, crowd.agents);
    now.close();
    CHECK(Log::frames_in(file) == "1|0|0\n");
    CHECK(files_in(folder.path).size() == 1);
}

TEST_CASE("Trajectories have JuPedSim's tables, version 2, and one file remains") {
    TemporaryFolder folder;
    const fs::path file = folder.path / "trajectories.sqlite";
    Scene scene = one_agent_scene(10, 25, 75, 50, 0.2);
    scene.crowd->groups[0].count = scene.crowd->groups[0].columns = 2;
    scene.obstacles.push_back({{60, 67}, {21.5, 28.5}, 1});
    CrowdWorld crowd = make_crowd(scene);
    scene.crowd->step_rate = 45;
    scene.crowd->paths.rate = 22.5;
    TrajectoryFile trajectories(file, scene);
    trajectories.write(0, crowd.agents);
    crowd.agents.outcome[0] = Outcome::arrived;
    crowd.agents.end_step[0] = 2;
    trajectories.write(1, crowd.agents, 0);
    trajectories.write(2, crowd.agents, 2);
    trajectories.close();

    CHECK(query(file, "SELECT key, value FROM metadata ORDER BY key") ==
          "fps|22.5\nversion|2\nxmax|100\nxmin|0\nymax|50\nymin|0\n");
    CHECK(query(file, "SELECT frame, id, pos_x, pos_y FROM trajectory_data ORDER BY frame, id") ==
          "0|0|10.0|25.0\n0|1|11.0|25.0\n1|0|10.0|25.0\n1|1|11.0|25.0\n2|1|11.0|25.0\n");
    CHECK(query(file, "SELECT count(*) FROM trajectory_data WHERE abs(ori_x*ori_x + ori_y*ori_y - 1) > 1e-9") == "0\n");
    CHECK(query(file, "SELECT frame FROM frame_data f JOIN geometry g ON f.geometry_hash = g.hash ORDER BY frame") ==
          "0\n1\n2\n");
    CHECK(query(file, "SELECT wkt FROM geometry") ==
          "POLYGON ((0 0, 100 0, 100 50, 0 50, 0 0), (60 21.5, 67 21.5, 67 28.5, 60 28.5, 60 21.5))\n");
    CHECK(query(file, "SELECT group_concat(name) FROM pragma_table_info('trajectory_data')") ==
          "frame,id,pos_x,pos_y,ori_x,ori_y\n");
    // The key is the order of the rows, so that a frame is found without reading the others.
    CHECK_THAT(query(file, "EXPLAIN QUERY PLAN SELECT pos_x FROM trajectory_data WHERE frame = 1 AND id = 1"),
               Catch::Contains("USING PRIMARY KEY (frame=? AND id=?)"));
    CHECK(query(file, "PRAGMA journal_mode") == "delete\n");
    CHECK(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()) == 1);
}

TEST_CASE("When the database cannot grow, the error says so and the frames written before are whole") {
    TemporaryFolder folder;
    const fs::path file = folder.path / "trajectories.sqlite";
    Scene scene = one_agent_scene(10, 1, 75, 50, 0.2);
    scene.crowd->groups[0].columns = scene.crowd->groups[0].count = 20;
    const CrowdWorld crowd = make_crowd(scene);
    std::uint64_t frame = 0;
    std::string message;
    bool full = false;
    {
        TrajectoryFile trajectories(file, scene, {.pages = 20});
        try {
            for (; frame < 100000; ++frame) trajectories.write(frame, crowd.agents);
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

TEST_CASE("A row takes less than 49 bytes once the file is closed, however many there are and whatever its name") {
    TemporaryFolder folder;
    const fs::path file = folder.path / "it's trajectories.sqlite";
    Scene scene = at_every_step(one_agent_scene(10, 1, 75, 50, 0.2));
    scene.crowd->groups[0].columns = scene.crowd->groups[0].count = 1000;
    scene.crowd->groups[0].pitch_x = 0.05;
    CrowdWorld crowd = make_crowd(scene);
    const std::uint64_t frames = GENERATE(20U, 300U);
    {
        TrajectoryFile trajectories(file, scene);
        for (std::uint64_t frame = 0; frame < frames; ++frame) {
            for (Vector2d& p : crowd.agents.position) p += Vector2d(1e-3, 1e-3);
            trajectories.write(frame, crowd.agents);
        }
        trajectories.close();
    }
    CHECK(static_cast<double>(fs::file_size(file)) / static_cast<double>(1000 * frames) <= (frames > 100 ? 49 : 57));
    CHECK(query(file, "SELECT count(*), max(frame) FROM trajectory_data") ==
          std::to_string(1000 * frames) + "|" + std::to_string(frames - 1) + "\n");
    CHECK(query(file, "PRAGMA integrity_check") == "ok\n");
    CHECK(files_in(folder.path).size() == 1);
}

TEST_CASE("Files that may not grow further count as a full disk, and the frames written before are whole") {
    TemporaryFolder folder;
    const fs::path file = folder.path / "trajectories.sqlite";
    CHECK(in_killed_process([&] {
        ::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{600'000, RLIM_INFINITY};
        ::setrlimit(RLIMIT_FSIZE, &limit);
        Scene scene = at_every_step(one_agent_scene(10, 1, 75, 50, 0.2));
        scene.crowd->groups[0].columns = scene.crowd->groups[0].count = 500;
        scene.crowd->groups[0].pitch_x = 0.1;
        const CrowdWorld crowd = make_crowd(scene);
        TrajectoryFile trajectories(file, scene);
        try {
            for (std::uint64_t frame = 0; frame < 1000; ++frame) trajectories.write(frame, crowd.agents);
        } catch (const OutputError& error) {
            if (error.disk_full()) return;
        }
        throw std::runtime_error("not full");
    }));
    CHECK(query(file, "SELECT count(*) > 0, count(*) = 500 * (max(frame) + 1) FROM trajectory_data") == "1|1\n");
}

TEST_CASE("Frames come at the rate of the paths, and everybody's first and last place is in one") {
    struct Rates {
        double steps, paths, fps;
        int steps_per_frame;
    };
    const auto rates = GENERATE(Rates{30, 4, 3.75, 8}, Rates{30, 10, 10, 3}, Rates{30, 30, 30, 1},
                                Rates{30, 100, 30, 1}, Rates{2, 4, 2, 1}, Rates{25, 10, 25.0 / 3, 3});
    TemporaryFolder folder;
    Scene scene = one_agent_scene(20, 20, 20, 25, 0.2);
    scene.crowd->groups[0].count = scene.crowd->groups[0].columns = 4;
    scene.crowd->groups[0].pitch_x = 4;  // so that they arrive at different times, the last ones not at all
    scene.crowd->step_rate = scene.frame_rate = rates.steps;
    scene.crowd->paths.rate = rates.paths;
    CrowdWorld crowd = make_crowd(scene);
    const std::vector<Vector2d> first = crowd.agents.position;
    RunFolder run(folder.path, crowd, RunLabels{}, Record{});
    const int steps = static_cast<int>(4.5 * rates.steps) + 1;
    for (int k = 0; k < steps; ++k) {
        step(crowd, {});
        run.record(crowd, {});
    }
    REQUIRE(crowd.arrived > 0);
    REQUIRE(!crowd.active.empty());
    RunSummary summary;
    run.finish(crowd, summary, RunLabels{});

    const fs::path file = folder.path / "trajectories.sqlite";
    const int frames = (steps + rates.steps_per_frame - 1) / rates.steps_per_frame + 1;
    CHECK(std::stod(query(file, "SELECT value FROM metadata WHERE key = 'fps'")) == rates.fps);
    CHECK(query(file, "SELECT count(*), min(frame), max(frame) FROM frame_data") ==
          std::to_string(frames) + "|0|" + std::to_string(frames - 1) + "\n");
    for (std::size_t id = 0; id < crowd.agents.size(); ++id) {
        const std::string of_agent = " FROM trajectory_data WHERE id = " + std::to_string(id);
        const auto place = [&](const std::string& which) {
            return query(file, "SELECT printf('%.12f', pos_x), printf('%.12f', pos_y)" + of_agent + " ORDER BY frame " +
                                   which + " LIMIT 1");
        };
        const auto shown = [](const Vector2d& p) {
            char text[80];
            std::snprintf(text, sizeof text, "%.12f|%.12f\n", p.x(), p.y());
            return std::string(text);
        };
        CHECK(place("ASC") == shown(first[id]));
        CHECK(place("DESC") == shown(crowd.agents.position[id]));
        // In each frame up to the first since the end.
        const auto end =
            crowd.agents.outcome[id] == Outcome::active ? static_cast<std::uint64_t>(steps) : crowd.agents.end_step[id];
        const auto per_frame = static_cast<std::uint64_t>(rates.steps_per_frame);
        CHECK(query(file, "SELECT count(*), max(frame)" + of_agent) ==
              std::to_string((end + per_frame - 1) / per_frame + 1) + "|" +
                  std::to_string((end + per_frame - 1) / per_frame) + "\n");
    }
}
