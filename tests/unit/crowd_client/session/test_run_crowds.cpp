// Many crowds in one water.

#include <atomic>
#include <catch2/catch.hpp>
#include <csignal>
#include <memory>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "crowd_client/markers/counter_random.hpp"
#include "crowd_client/outputs/writers/report.hpp"
#include "crowd_client/session/run_crowds.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::MadeUpSource;
using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::one_agent_scene;

namespace {

// Scattered particles that drift towards -x and are elsewhere in each frame.
MadeUpWater wild_water(std::uint64_t frame) {
    MadeUpWater water;
    for (std::uint64_t i = 0; i < 8000; ++i) {
        water.add(20 * counter_uniform(frame, 0, i), 10 + 20 * counter_uniform(frame, 1, i), 100,
                  -2 * counter_uniform(frame, 2, i), 0.1);
    }
    return water;
}

Scene rows_of_agents(std::uint64_t seed, double tau, double step_rate = 30) {
    Scene scene = one_agent_scene(4, 12, 10, 40, tau);
    AgentGroup& group = scene.crowd->groups[0];
    group.columns = 6;
    group.rows = 3;
    group.count = 18;
    scene.seed = seed;
    scene.duration = 2;
    scene.crowd->step_rate = step_rate;
    return scene;
}

std::vector<Scene> different_scenes() {
    std::vector<Scene> scenes{rows_of_agents(1, 0.2),     rows_of_agents(2, 0.2),
                              rows_of_agents(1, 1),       rows_of_agents(1, 0.2, 75),
                              rows_of_agents(1, 0.5, 10), one_agent_scene(74, 45, 75, 50, 0)};
    scenes.back().duration = 2;
    scenes[1].coupling->contact_rule = ContactRule::sum;
    scenes[2].coupling->rule = CouplingRule::continuous;
    scenes[2].crowd->groups[0].mass = {40, 100};
    TauEvent event;
    event.frame = 20;
    event.tau = 0.9;
    scenes[0].events.push_back(event);
    return scenes;
}

std::vector<CrowdRun> runs_of(const std::vector<Scene>& scenes) {
    std::vector<CrowdRun> runs;
    for (const Scene& scene : scenes) runs.push_back({.crowd = make_crowd(scene), .summary = {}});
    return runs;
}

using Path = std::vector<Vector2d>;

void log_step(Path& path, const CrowdWorld& crowd) {
    for (std::size_t id = 0; id < crowd.agents.size(); ++id) path.push_back(crowd.agents.position[id]);
}

}  // namespace

TEST_CASE("Each of many crowds ends up, to the bit, as if it had been alone, for any number of threads") {
    const std::vector<Scene> scenes = different_scenes();
    for (const int threads : {1, 3}) {
        for (const std::uint64_t stride : {1U, 4U}) {
            std::vector<CrowdRun> runs = runs_of(scenes);
            std::vector<Path> paths(runs.size());
            RunHooks hooks;
            hooks.on_step = [&](std::size_t k, const WaterView&) { log_step(paths[k], runs[k].crowd); };
            MadeUpSource together(60 / stride, wild_water);
            together.stride = stride;
            run_crowds(runs, together, hooks, threads);
            for (std::size_t k = 0; k < scenes.size(); ++k) {
                INFO("crowd " << k << ", " << threads << " threads, every " << stride << ". frame");
                CrowdRun alone{.crowd = make_crowd(scenes[k])};
                Path path;
                RunHooks alone_hooks;
                alone_hooks.on_step = [&](std::size_t, const WaterView&) { log_step(path, alone.crowd); };
                MadeUpSource source(60 / stride, wild_water);
                source.stride = stride;
                run_crowds({&alone, 1}, source, alone_hooks);
                CHECK(paths[k] == path);
                CHECK(runs[k].over);
                CHECK(agents_csv(runs[k].crowd) == agents_csv(alone.crowd));
                CHECK(outcome_json(runs[k].crowd, runs[k].summary, {}) == outcome_json(alone.crowd, alone.summary, {}));
            }
        }
    }
}

TEST_CASE("The water is taken once a frame and told when the last crowd is over") {
    Scene near = one_agent_scene(74, 45, 75, 50, 0), nearer = one_agent_scene(74.5, 46, 75, 50, 0);
    std::vector<CrowdRun> runs = runs_of({near, nearer});
    std::vector<std::size_t> over;
    std::vector<std::uint64_t> steps_seen(2);
    RunHooks hooks;
    hooks.on_over = [&](std::size_t k) {
        over.push_back(k);
        CHECK(runs[k].summary.status == "completed");
    };
    hooks.on_step = [&](std::size_t k, const WaterView&) { ++steps_seen[k]; };
    MadeUpSource source(1000, [](std::uint64_t) { return MadeUpWater{}; });
    run_crowds(runs, source, hooks, 1);
    CHECK(over == std::vector<std::size_t>{1, 0});
    CHECK(source.left);
    CHECK(source.released == runs[0].summary.frames);
    CHECK(steps_seen[1] == runs[1].crowd.steps);  // none after its end
    CHECK(runs[1].summary.frames < runs[0].summary.frames);
}

TEST_CASE("A stream that ends early ends all crowds that are not over") {
    std::vector<CrowdRun> runs = runs_of({one_agent_scene(74, 46.9, 75, 50, 0), one_agent_scene(10, 25, 75, 50, 0)});
    MadeUpSource source(12, [](std::uint64_t) { return MadeUpWater{}; });
    run_crowds(runs, source, {}, 2);
    CHECK(runs[0].summary.status == "completed");
    CHECK(runs[1].summary.status == "stream_ended");
    CHECK(runs[1].summary.message == "the stream of water ended after frame 12, before the scene's duration was over");
    CHECK_FALSE(source.left);
}

TEST_CASE("A failing log of one crowd ends this crowd; the others walk on as if nothing had happened") {
    const std::vector<Scene> scenes(3, one_agent_scene(74, 45, 75, 50, 0));
    for (const int threads : {1, 2}) {
        std::vector<CrowdRun> runs = runs_of(scenes), sound = runs_of(scenes);
        MadeUpSource source(1000, [](std::uint64_t) { return MadeUpWater{}; });
        std::vector<std::size_t> over;
        RunHooks hooks;
        hooks.on_step = [&](std::size_t k, const WaterView&) {
            if (k == 1 && runs[k].crowd.steps == 5) throw RunError(ExitCode::unexpected, "no space left");
        };
        hooks.on_over = [&](std::size_t k) { over.push_back(k); };
        run_crowds(runs, source, hooks, threads);
        MadeUpSource same(1000, [](std::uint64_t) { return MadeUpWater{}; });
        run_crowds(sound, same, {}, 1);
        CHECK(over == std::vector<std::size_t>{1, 0, 2});
        CHECK(runs[1].failure != nullptr);
        CHECK(runs[1].summary.status == "failed");
        CHECK(runs[1].summary.message == "no space left");
        CHECK(runs[1].summary.frames == 4);
        CHECK(runs[1].crowd.steps == 5);
        for (const std::size_t k : {0U, 2U}) {
            CHECK(runs[k].failure == nullptr);
            CHECK(outcome_json(runs[k].crowd, runs[k].summary, {}) ==
                  outcome_json(sound[k].crowd, sound[k].summary, {}));
        }
        CHECK(source.left);
        CHECK(source.abort_text.empty());
    }
}

TEST_CASE("Where the logs of all crowds fail the run ends and the producer is told why") {
    std::vector<CrowdRun> runs = runs_of({one_agent_scene(10, 25, 75, 50, 0), one_agent_scene(10, 25, 75, 50, 0)});
    MadeUpSource source(1000, [](std::uint64_t) { return MadeUpWater{}; });
    RunHooks hooks;
    int told = 0;
    hooks.on_step = [](std::size_t, const WaterView&) { throw RunError(ExitCode::unexpected, "no space left"); };
    hooks.on_over = [&](std::size_t) { ++told; };
    CHECK_THROWS_WITH(run_crowds(runs, source, hooks, 1), "no space left");
    CHECK(source.abort_text == "no space left");
    CHECK(told == 2);
}

TEST_CASE("A crowd whose last files fail changes no other, not even one that is over with the same frame") {
    std::vector<CrowdRun> runs = runs_of({one_agent_scene(74, 46.9, 75, 50, 0), one_agent_scene(10, 25, 75, 50, 0),
                                          one_agent_scene(74, 46.9, 75, 50, 0)});
    runs[1].crowd.scene.duration = 1;
    MadeUpSource source(1000, [](std::uint64_t) { return MadeUpWater{}; });
    RunHooks hooks;
    hooks.on_over = [&](std::size_t k) {
        CHECK((runs[0].over && runs[2].over));
        CHECK(source.released == runs[k].summary.frames);  // the water does not wait for files
        if (k == 0) throw RunError(ExitCode::unexpected, "no agents.csv");
    };
    run_crowds(runs, source, hooks, 1);
    CHECK(runs[0].summary.status == "failed");
    CHECK(runs[0].summary.message == "no agents.csv");
    CHECK(runs[0].failure != nullptr);
    for (const std::size_t k : {1U, 2U}) {
        CHECK(runs[k].summary.status == "completed");
        CHECK(runs[k].failure == nullptr);
    }
    CHECK(source.left);
}

TEST_CASE("A signal is obeyed between two steps of a frame") {
    Scene scene = one_agent_scene(10, 25, 75, 50, 0);
    scene.crowd->step_rate = 3000;  // 100 steps a frame
    for (const int threads : {1, 2}) {
        std::vector<CrowdRun> runs = runs_of({scene, scene});
        MadeUpSource source(1000, [](std::uint64_t) { return MadeUpWater{}; });
        RunHooks hooks;
        hooks.interrupted = [&] { return runs[0].crowd.steps >= 150 ? SIGINT : 0; };
        // Two threads would read this counter while the other one writes it.
        if (threads == 2) {
            hooks.interrupted = [n = std::make_shared<std::atomic<int>>(0)] { return ++*n > 250 ? SIGINT : 0; };
        }
        CHECK_THROWS_WITH(run_crowds(runs, source, hooks, threads),
                          Catch::Contains("interrupted by SIGINT after frame 1"));
        CHECK(runs[0].crowd.steps < 200);
        CHECK(runs[1].crowd.steps < 200);
        CHECK(runs[0].summary.frames == 1);
        CHECK_FALSE(runs[0].over);
    }
}

TEST_CASE("A signal ends the run of many crowds") {
    std::vector<CrowdRun> runs = runs_of({one_agent_scene(10, 25, 75, 50, 0)});
    MadeUpSource source(1000, [](std::uint64_t) { return MadeUpWater{}; });
    RunHooks hooks;
    hooks.interrupted = [&] { return runs[0].summary.frames == 7 ? SIGTERM : 0; };
    CHECK_THROWS_WITH(run_crowds(runs, source, hooks, 1), "interrupted by SIGTERM after frame 7");
    CHECK(source.abort_code == 143);
}
