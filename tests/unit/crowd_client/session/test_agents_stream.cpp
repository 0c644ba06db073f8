// The agents stream from the crowd to the water, as a consumer reads it.

#include <unistd.h>

#include <catch2/catch.hpp>
#include <exception>
#include <thread>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "crowd_client/session/run_crowds.hpp"
#include "made_up_water.hpp"
#include "shm_protocol/inside/bytes/hash.hpp"
#include "shm_protocol/subscriber.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::MadeUpSource;
using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::one_agent_scene;

namespace {

std::string unique_session(const char* name) {
    return "wade-test-agents-" + std::to_string(::getpid()) + "-" + name;
}

MadeUpWater no_water(std::uint64_t) {
    return {};
}

// Three agents: one walks, one arrives in the first step, one is washed over the fall in the first step.
Scene three_fates(wade::AgentsStream lag) {
    Scene scene = one_agent_scene(10, 25, 75, 50, 0.2);
    AgentGroup group = scene.crowd->groups[0];
    group.name = "near";
    group.start_x = 75.0;
    group.start_z = 46.98;
    scene.crowd->groups.push_back(group);
    group.name = "swept";
    group.start_x = 0.01;
    group.start_z = 30;
    group.mass = 40;
    group.tau = 1;
    scene.crowd->groups.push_back(group);
    scene.coupling->agents_stream = lag;
    scene.coupling->agent_radius = 0.6;
    scene.hash = 42;
    scene.duration = 0.5;
    return scene;
}

MadeUpWater stream_at_the_fall(std::uint64_t) {
    return testing::uniform_water(0, 2, 28, 32, 1, 0.25, -4, 0);
}

struct SeenFrame {
    std::uint64_t frame, tick;
    bool final;
    std::vector<std::vector<float>> fields;  // in the order of the contract
};

// A consumer on a thread of its own that keeps what it sees.
class Consumer {
 public:
    explicit Consumer(const std::string& session, std::uint64_t frames_wanted = 1'000'000)
        : thread_([this, session, frames_wanted] {
              try {
                  take(session, frames_wanted);
              } catch (...) {
                  error = std::current_exception();
              }
          }) {}
    ~Consumer() { join(); }
    Consumer(const Consumer&) = delete;
    Consumer& operator=(const Consumer&) = delete;
    void join() {
        if (thread_.joinable()) thread_.join();
    }

    shm::StreamInfo info;
    std::vector<SeenFrame> seen;
    std::uint64_t last_hash = 0;
    std::exception_ptr error;

 private:
    void take(const std::string& session, std::uint64_t frames_wanted) {
        shm::Subscriber subscriber(session, "water", shm::JoinOptions{.scene_hash = 42, .kind = shm::stream_agents});
        info = subscriber.info();
        while (seen.size() < frames_wanted) {
            const auto f = subscriber.acquire();
            if (!f) return;
            SeenFrame copy{f->frame, f->tick, f->final, {}};
            for (const auto& field : {f->mass, f->vx, f->vy, f->vz, f->px, f->py, f->pz, f->radius, f->height, f->state,
                                      f->jx, f->jz, f->submerged, f->spread}) {
                copy.fields.emplace_back(field.begin(), field.end());
            }
            seen.push_back(copy);
            last_hash = f->hash;
            subscriber.release();
        }
        subscriber.leave();
    }

    std::thread thread_;
};

enum Field { mass, vx, vy, vz, px, py, pz, radius, height, state, jx, jz, submerged, spread };

struct RunWithAgents {
    CrowdRun one;
    const CrowdWorld& crowd = one.crowd;
    const RunSummary& summary = one.summary;
    Consumer consumer;

    RunWithAgents(const char* name, const Scene& scene, MadeUpSource& source, std::uint64_t frames_wanted = 1'000'000,
                  const RunHooks& hooks = {})
        : one{.crowd = make_crowd(scene)}, consumer(unique_session(name), frames_wanted) {
        AgentsPublisher agents(unique_session(name), crowd, source.info(), {});
        run_crowds({&one, 1}, source, hooks, 1, &agents);
        consumer.join();
    }
};

}  // namespace

TEST_CASE("The header of the agents stream says its lag, depth, ticks and capacity") {
    for (const auto lag : {wade::AgentsStream::serial, wade::AgentsStream::parallel}) {
        MadeUpSource source(1000, no_water);
        source.stream.ticks_per_second = 30'000;
        source.stream.ticks_per_frame = 1000;
        source.tick_of = [](std::uint64_t frame) { return 1000 * frame; };
        const RunWithAgents run("header", three_fates(lag), source);
        const shm::StreamInfo& info = run.consumer.info;
        const bool parallel = lag == wade::AgentsStream::parallel;
        CHECK(info.kind == shm::stream_agents);
        CHECK(info.coupling_lag == (parallel ? 1 : 0));
        CHECK(info.depth == (parallel ? 2 : 1));
        CHECK(info.capacity == 3);
        CHECK(info.ticks_per_second == 30'000);
        CHECK(info.ticks_per_frame == 1000);
        CHECK(info.scene_hash == 42);
        CHECK(info.in_world_coordinates());
    }
}

TEST_CASE("Agents frame f + 1 follows frame f of the water, the first one is the start, the last one is final") {
    MadeUpSource source(1000, no_water);
    const RunWithAgents run("order", three_fates(wade::AgentsStream::serial), source);
    REQUIRE(run.consumer.seen.size() == run.summary.frames + 1);
    for (std::size_t i = 0; i < run.consumer.seen.size(); ++i) {
        const SeenFrame& frame = run.consumer.seen[i];
        CHECK(frame.frame == i + 1);
        CHECK(frame.tick == i);
        CHECK(frame.final == (i == run.summary.frames));
    }
    CHECK(run.consumer.error == nullptr);
}

TEST_CASE("Each frame has all agents with what they are and what became of them") {
    MadeUpSource source(1000, stream_at_the_fall);
    const RunWithAgents run("fields", three_fates(wade::AgentsStream::serial), source);
    REQUIRE(run.crowd.agents.outcome[1] == Outcome::arrived);
    REQUIRE(run.crowd.agents.outcome[2] == Outcome::dead);
    const auto& first = run.consumer.seen.front().fields;
    CHECK(first[mass] == std::vector<float>{65, 65, 40});
    CHECK(first[px] == std::vector<float>{10, 75, 0.01F});
    CHECK(first[py] == std::vector<float>{0, 0, 0});
    CHECK(first[pz] == std::vector<float>{25, 46.98F, 30});
    CHECK(first[vx] == std::vector<float>{0, 0, 0});
    CHECK(first[radius] == std::vector<float>{0.6F, 0.6F, 0.6F});
    CHECK(first[height] == std::vector<float>{1.7F, 1.7F, 1.7F});
    CHECK(first[state] == std::vector<float>{0, 0, 0});
    const auto& last = run.consumer.seen.back().fields;
    CHECK(last[state] == std::vector<float>{0, 1, 2});
    for (std::size_t id = 0; id < 3; ++id) {
        CHECK(last[px][id] == static_cast<float>(run.crowd.agents.position[id].x()));
        CHECK(last[pz][id] == static_cast<float>(run.crowd.agents.position[id].y()));
        CHECK(last[vy][id] == 0);
    }
    CHECK(last[vx][0] == static_cast<float>(run.crowd.agents.velocity[0].x()));
    CHECK(last[vz][0] == static_cast<float>(run.crowd.agents.velocity[0].y()));
    CHECK(last[vz][0] != 0);
    CHECK(last[vx][2] == 0);  // whoever has ended rests
}

TEST_CASE(
    "People who push the water say in each frame what it gave them since the frame before, to the last bit in sum") {
    Scene scene = three_fates(wade::AgentsStream::parallel);
    scene.coupling->two_way = true;
    scene.crowd->step_rate = 60;
    scene.hash = 42;
    MadeUpSource source(1000, [](std::uint64_t) { return testing::uniform_water(5, 15, 20, 30, 1, 0.25, -1, 0.5); });
    const RunWithAgents run("impulses", scene, source);
    CHECK(run.consumer.info.impulses);
    Vector2d sum = Vector2d::Zero();
    for (const SeenFrame& frame : run.consumer.seen) {
        sum += Vector2d(static_cast<double>(frame.fields[jx][0]), static_cast<double>(frame.fields[jz][0]));
        CHECK(frame.fields[jx][1] == 0);  // on dry ground
        CHECK(frame.fields[submerged][1] == 0);
        CHECK(frame.fields[spread][0] > 0.49F);
    }
    const auto& first = run.consumer.seen.front().fields;
    CHECK((first[jx][0] == 0 && first[jz][0] == 0));  // no agent has taken a step
    const auto& second = run.consumer.seen[1].fields;
    // Two steps of the drag, 1.1 x 0.272 m x 500 kg/m2 x 1 m, on |u| of about 1.1 m/s, corrected by some 19 %.
    CHECK(static_cast<double>(second[jx][0]) < -4);
    CHECK(static_cast<double>(second[jx][0]) > -9);
    CHECK(static_cast<double>(second[submerged][0]) == Approx(1).margin(0.1));
    // The rounding to float of a frame comes with the next: what is missing in the end is that of one frame.
    CHECK(sum.x() == Approx(run.crowd.pushing->given[0].x()).margin(1e-6));
    CHECK(sum.y() == Approx(run.crowd.pushing->given[0].y()).margin(1e-6));
    CHECK_FALSE(run.summary.momentum);  // a water that says nothing of people has no balance
}

TEST_CASE("The hash of the agents is that of the stream, the same for both lags and without anybody who takes it") {
    std::vector<std::uint64_t> hashes;
    for (const auto lag : {wade::AgentsStream::serial, wade::AgentsStream::parallel}) {
        for (const std::uint64_t wanted : {std::uint64_t{1'000'000}, std::uint64_t{2}}) {
            MadeUpSource source(1000, stream_at_the_fall);
            const RunWithAgents run("hash", three_fates(lag), source, wanted);
            if (wanted > 2) CHECK(run.summary.agents_hash == run.consumer.last_hash);
            CHECK(run.summary.status == "completed");
            hashes.push_back(run.summary.agents_hash);
        }
    }
    CHECK(hashes[0] != 0);
    CHECK(hashes == std::vector<std::uint64_t>(4, hashes[0]));
}

TEST_CASE("A water whose first frame is at tick 0 gets agents frames of increasing ticks") {
    MadeUpSource source(1000, no_water);
    source.tick_of = [](std::uint64_t frame) { return frame - 1; };
    const RunWithAgents run("tick0", three_fates(wade::AgentsStream::serial), source);
    CHECK(run.consumer.error == nullptr);
    REQUIRE(run.consumer.seen.size() == 17);
    CHECK(run.consumer.seen[1].tick == 1);
    CHECK(run.consumer.seen[16].tick == 16);
}

TEST_CASE("Agents are published before the water's frame is released") {
    MadeUpSource source(1000, no_water);
    const Scene scene = three_fates(wade::AgentsStream::serial);
    CrowdRun one{.crowd = make_crowd(scene)};
    CrowdWorld& crowd = one.crowd;
    shm::JoinOptions options{.kind = shm::stream_agents};
    options.waiting.step_timeout_s = 1;  // what is not there now never comes
    AgentsPublisher agents(unique_session("before"), crowd, source.info(), options.waiting);
    shm::Subscriber water(unique_session("before"), "water", options);
    std::uint64_t taken = 0;
    // One thread plays both sides.
    const auto take_up_to = [&](std::uint64_t frame) {
        for (; taken < frame; ++taken) {
            REQUIRE(water.acquire());
            water.release();
        }
    };
    RunHooks hooks;
    hooks.before_frame = [&] { take_up_to(source.released + 1); };
    source.on_release = [&] { take_up_to(source.released + 2); };
    run_crowds({&one, 1}, source, hooks, 1, &agents);
    CHECK(taken == 16);
}

TEST_CASE("When the log fails both streams learn the reason") {
    MadeUpSource source(1000, no_water);
    const Scene scene = three_fates(wade::AgentsStream::serial);
    CrowdRun one{.crowd = make_crowd(scene)};
    CrowdWorld& crowd = one.crowd;
    Consumer consumer(unique_session("log"));
    AgentsPublisher agents(unique_session("log"), crowd, source.info(), {});
    RunHooks hooks;
    hooks.on_step = [&](std::size_t, const WaterView&) {
        if (crowd.steps == 5) throw RunError(ExitCode::unexpected, "no space left");
    };
    CHECK_THROWS_WITH(run_crowds({&one, 1}, source, hooks, 1, &agents), "no space left");
    consumer.join();
    CHECK(source.abort_text == "no space left");
    REQUIRE(consumer.error);
    CHECK_THROWS_WITH(std::rethrow_exception(consumer.error), Catch::Contains("no space left"));
    CHECK(consumer.seen.size() == 5);
}

TEST_CASE("When the consumer of the agents gives up the water's stream is told") {
    MadeUpSource source(1000, no_water);
    const Scene scene = three_fates(wade::AgentsStream::serial);
    CrowdRun one{.crowd = make_crowd(scene)};
    CrowdWorld& crowd = one.crowd;
    AgentsPublisher agents(unique_session("water"), crowd, source.info(), {});
    shm::Subscriber water(unique_session("water"), "water", {.kind = shm::stream_agents});
    RunHooks hooks;
    hooks.before_frame = [&] { water.abort(9, "the water blew up"); };
    CHECK_THROWS_WITH(run_crowds({&one, 1}, source, hooks, 1, &agents), Catch::Contains("the water blew up"));
    CHECK(source.abort_code == 5);
    CHECK_THAT(source.abort_text, Catch::Contains("the water blew up"));
}
