#include "outputs/conformance.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <csignal>
#include <set>

#include "configs/scene/channel.hpp"
#include "configs/scene/crowd.hpp"
#include "crowd_client/outputs/run_folder.hpp"
#include "crowd_client/outputs/writers/danger.hpp"
#include "crowd_client/results/output_file.hpp"
#include "made_up_water.hpp"
#include "outputs/run_files.hpp"

namespace wade::crowd::testing {
namespace {

constexpr int all_steps = 30;
constexpr Record everything{.water_interval = 0.1, .danger_window = 0.5, .trajectories = true, .terms_interval = 0.1};

Scene scene_with_all() {
    Scene scene = one_agent_scene(50, 25, 75, 50, 0.9);
    scene.crowd->groups[0].count = scene.crowd->groups[0].columns = 10;
    scene.channel->velocity = 2.5;
    scene.crowd->paths.rate = scene.crowd->pose_rate = scene.crowd->step_rate;
    scene.crowd->ragdoll.condition = RagdollCondition::paper;
    return scene;
}

// A run of this output alone.
struct OneOutput {
    CrowdWorld crowd = make_crowd(scene_with_all());
    MadeUpWater water = uniform_water(30, 80, 15, 35, 1, 0.5, -2.5, 0);
    RunSummary summary;
    RunLabels labels;
    RunFolder folder;

    OneOutput(const std::filesystem::path& path, const RegisteredOutput& output)
        : labels(reproducible()), folder(path, crowd, labels, everything, {}, {&output, 1}) {}

    static RunLabels reproducible() {
        RunLabels labels;
        labels.canonical_scene = R"({"name": "x", "events": []})";
        labels.reproducible = true;
        return labels;
    }
    void walk(int n) {
        for (int i = 0; i < n; ++i) {
            if (crowd.steps == 5) folder.record_event({7, 0, std::nullopt, 1});
            step(crowd, water.view());
            folder.record(crowd, water.view());
        }
    }
    void finish() {
        summary.status = "completed";
        folder.finish(crowd, summary, labels);
    }
};

std::set<std::string> names_of(const RegisteredOutput& output) {
    std::set<std::string> names;
    for (const std::string_view file : output.files) names.insert(std::string(file));
    names.erase("");
    return names;
}

using Files = std::map<std::string, std::string>;

Files run_of(const RegisteredOutput& output, const std::filesystem::path& path) {
    OneOutput run(path, output);
    run.walk(all_steps);
    run.finish();
    return files_in(path);
}

// Files of a process may have this size, as if the disk was full beyond it.
void limit_files(rlim_t bytes) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, RLIM_INFINITY};
    ::setrlimit(RLIMIT_FSIZE, &limit);
}

// Whether an output that meets a full disk after any number of bytes says so and finishes once there is space.
bool survives_a_full_disk(const RegisteredOutput& output, const std::filesystem::path& path, rlim_t bytes) {
    return in_killed_process([&] {
        std::optional<OneOutput> run;
        try {
            run.emplace(path, output);
        } catch (const OutputError&) {
            return;  // not even the begin
        }
        limit_files(bytes);
        try {
            run->walk(all_steps);
        } catch (const OutputError& error) {
            fail_summary(run->summary, error);
        }
        limit_files(RLIM_INFINITY);
        run->folder.finish(run->crowd, run->summary, run->labels);
    });
}

// Files that grow are in a killed run what they were at that time; others are whole, or not there yet.
void check_killed(const RegisteredOutput& output) {
    TemporaryFolder half, killed;
    {
        OneOutput run(half.path, output);
        run.walk(all_steps / 2);
        run.finish();
    }
    REQUIRE(in_killed_process([&] {
        auto* const run = new OneOutput(killed.path, output);
        run->walk(all_steps / 2);
    }));
    for (const auto& [name, content] : files_in(half.path)) {
        const std::filesystem::path left = killed.path / name;
        if (name.ends_with(".sqlite")) {
            CHECK(query(left, "SELECT count(*) FROM trajectory_data") ==
                  query(half.path / name, "SELECT count(*) FROM trajectory_data"));
        } else if (output.turn == Turn::growing) {
            CHECK(content_of(left) == content);
        }
    }
    // Another run in this folder starts anew.
    TemporaryFolder fresh;
    CHECK(run_of(output, killed.path) == run_of(output, fresh.path));
}

}  // namespace

void check_output(const RegisteredOutput& output) {
    REQUIRE_FALSE(output.files[0].empty());
    const std::set<std::string> names = names_of(output);
    TemporaryFolder first, second;
    OneOutput run(first.path, output);
    run.walk(all_steps);
    run.folder.keep_results(run.crowd, run.summary, run.labels);
    run.finish();
    const Files files = files_in(first.path);
    CHECK(files.contains(std::string(output.files[0])));
    std::size_t bytes = 0;
    for (const auto& [name, content] : files) {
        INFO(name);
        CHECK(names.contains(name));
        CHECK_FALSE(content.empty());
        bytes += content.size();
    }
    run.finish();
    CHECK(files_in(first.path) == files);
    CHECK(run_of(output, second.path) == files);
    if (output.turn != Turn::growing) {
        OutputPlace place{first.path, run.crowd, run.labels, everything, nullptr, [](const std::string&) {}};
        place.danger = std::make_shared<DangerRecord>(run.crowd.scene, run.crowd.agents.size(), 0.5);
        CHECK(bytes <= output.make(place)->bytes_at_end());
    }
    check_killed(output);
    for (const rlim_t limit : {0U, 100U, 5000U}) {
        INFO("full after " << limit << " bytes");
        TemporaryFolder full;
        CHECK(survives_a_full_disk(output, full.path, limit));
    }
    const Scene plain = one_agent_scene(50, 25, 75, 50, 0.9);
    if (output.wanted(plain, {.water_interval = 0, .danger_window = 0, .trajectories = false})) return;
    // Not asked for, it is not there.
    TemporaryFolder none;
    const CrowdWorld crowd = make_crowd(plain);
    RunFolder(none.path, crowd, RunLabels{}, {.water_interval = 0, .danger_window = 0, .trajectories = false}, {},
              {&output, 1});
    CHECK(files_in(none.path).empty());
}

}  // namespace wade::crowd::testing
