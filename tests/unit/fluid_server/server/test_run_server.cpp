#include <unistd.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <exception>
#include <thread>
#include <vector>

#include "configs/scene/coupling.hpp"
#include "fluid_server/dfsph/dfsph_model.hpp"
#include "fluid_server/server/run_server.hpp"
#include "fluid_server/server/threads_in_use.hpp"
#include "frame_arrays.hpp"
#include "scenes.hpp"
#include "shm_protocol/subscriber.hpp"

using namespace wade;
using namespace wade::fluid;

namespace {

constexpr std::uint64_t frame_ticks = 100'000;  // at 30 frames a second

std::string session_of_its_own() {
    static int n = 0;
    return "test-fluid-server-" + std::to_string(::getpid()) + "-" + std::to_string(++n);
}

// A model of one particle; its height is the frame number. It stores all that it receives.
class Counter final : public fluid::FluidModel {
 public:
    [[nodiscard]] std::string_view name() const override { return "counter"; }
    [[nodiscard]] std::uint32_t capacity() const override { return 4; }
    void take_agents(const AgentsView& agents) override {
        agents_before.back() = agents.frame;
        agents_ticks.push_back(agents.tick);
        agents_x.push_back(agents.px[0]);
    }
    shm::Diagnostics advance_frame(const FrameInterval& interval) override {
        intervals.push_back(interval);
        agents_before.push_back(0);
        return {};
    }
    std::uint32_t write_frame(const shm::FrameFields& slot) const override {
        for (const auto& field : {slot.mass, slot.vx, slot.vy, slot.vz, slot.px, slot.pz}) field[0] = 1;
        slot.py[0] = static_cast<float>(slot.frame);
        return 1;
    }

    std::vector<FrameInterval> intervals;
    std::vector<std::uint64_t> agents_before{0};  // frame f - 1 of this: the agents that frame f was computed with
    std::vector<std::uint64_t> agents_ticks;
    std::vector<float> agents_x;
};

Scene short_scene(double rate, double duration) {
    Scene scene;
    scene.frame_rate = rate;
    scene.duration = duration;
    scene.hash = 42;
    return scene;
}

shm::Waiting patient() {
    shm::Waiting waiting;
    waiting.attach_timeout_s = 60;
    return waiting;
}

shm::JoinOptions joining(shm::StreamKind kind = shm::stream_fluid) {
    shm::JoinOptions options;
    options.scene_hash = 42;
    options.waiting = patient();
    options.kind = kind;
    return options;
}

// A crowd in a thread of its own; what it threw is there after join().
class CrowdThread {
 public:
    template <typename Work>
    explicit CrowdThread(Work&& work)
        : thread_([this, work] {
              try {
                  work();
              } catch (...) {
                  error = std::current_exception();
              }
          }) {}
    ~CrowdThread() {
        if (thread_.joinable()) thread_.join();
    }
    void join() { thread_.join(); }
    std::exception_ptr error;

 private:
    std::thread thread_;
};

// Publishes agents f, takes the water f, `frames` times, and then goes.
void walk(const std::string& session, std::uint32_t lag, std::uint64_t frames) {
    shm::Subscriber water(session, "crowd", joining());
    shm::StreamInfo info;
    info.producer_name = "crowd";
    info.capacity = 1;
    info.depth = 1 + lag;
    info.ticks_per_second = water.info().ticks_per_second;
    info.ticks_per_frame = water.info().ticks_per_frame;
    info.scene_hash = 42;
    info.kind = shm::stream_agents;
    info.coupling_lag = lag;
    shm::Publisher agents(session, info, patient());
    agents.wait_for_consumers(1);
    for (std::uint64_t f = 1; f <= frames; ++f) {
        const auto slot = agents.begin_frame();
        if (!slot) break;
        for (const auto& field :
             {slot->mass, slot->vx, slot->vy, slot->vz, slot->py, slot->pz, slot->radius, slot->height, slot->state})
            field[0] = 0;
        slot->mass[0] = 65;
        slot->px[0] = 100 + static_cast<float>(f);
        agents.end_frame(1);
        if (!water.acquire()) break;
        water.release();
    }
    agents.close();
    water.leave();
}

}  // namespace

TEST_CASE("each frame carries the tick of its end and the last one says so", "[server]") {
    const Scene scene = short_scene(30, 0.2);
    const std::string session = session_of_its_own();
    Counter model;
    shm::Publisher publisher(session, stream_info(scene, model), patient());
    std::vector<std::uint64_t> ticks;
    std::vector<float> heights;
    std::vector<bool> finals;
    CrowdThread crowd([&] {
        shm::Subscriber water(session, "crowd", joining());
        while (const auto frame = water.acquire()) {
            ticks.push_back(frame->tick);
            heights.push_back(frame->py[0]);
            finals.push_back(frame->final);
            water.release();
        }
    });
    RunClock clock(scene, Pace::fast);
    ServerSummary summary;
    run_server({model, publisher, clock}, summary);
    crowd.join();
    CHECK(crowd.error == nullptr);
    constexpr std::uint64_t t = frame_ticks;
    CHECK(ticks == std::vector<std::uint64_t>{t, 2 * t, 3 * t, 4 * t, 5 * t, 6 * t});
    CHECK(heights == std::vector<float>{1, 2, 3, 4, 5, 6});
    CHECK(finals == std::vector<bool>{false, false, false, false, false, true});
    CHECK(summary.frames == 6);
    CHECK_FALSE(summary.crowd_left);
}

TEST_CASE("frames of variable length travel with their ticks", "[server]") {
    const Scene scene = short_scene(30, 0.2);
    const std::string session = session_of_its_own();
    Counter model;
    shm::Publisher publisher(session, stream_info(scene, model), patient());
    std::vector<std::uint64_t> ticks;
    CrowdThread crowd([&] {
        shm::Subscriber water(session, "crowd", joining());
        while (const auto frame = water.acquire()) {
            ticks.push_back(frame->tick);
            water.release();
        }
    });
    double now = 0;
    RunClock clock(scene, Pace::variable, {[&] { return now += 0.005; }, [](double) {}});
    ServerSummary summary;
    run_server({model, publisher, clock}, summary);
    crowd.join();
    REQUIRE(ticks.size() == model.intervals.size());
    for (std::size_t i = 0; i < ticks.size(); ++i) CHECK(ticks[i] == model.intervals[i].end_tick);
    CHECK(ticks.back() == 6 * frame_ticks);
    CHECK(ticks.size() != 6);
}

TEST_CASE("a server that waits for nobody runs to its end alone", "[server]") {
    const Scene scene = short_scene(30, 2);
    Counter model;
    shm::Publisher publisher(session_of_its_own(), stream_info(scene, model), patient());
    RunClock clock(scene, Pace::fast);
    ServerSummary summary;
    ServerRun run{model, publisher, clock};
    run.consumers = 0;
    run_server(run, summary);
    CHECK(publisher.published_frames() == 60);
    CHECK_FALSE(summary.crowd_left);
}

TEST_CASE("a server sends nothing before as many consumers have joined as it was told", "[server]") {
    const Scene scene = short_scene(30, 0.5);
    const std::string session = session_of_its_own();
    Counter model;
    shm::Waiting waiting = patient();
    waiting.attach_timeout_s = 0.3;
    shm::Publisher publisher(session, stream_info(scene, model), waiting);
    CrowdThread crowd([&] {
        shm::Subscriber water(session, "crowd", joining());
        while (water.acquire()) water.release();
    });
    RunClock clock(scene, Pace::fast);
    ServerSummary summary;
    ServerRun run{model, publisher, clock};
    run.consumers = 2;
    CHECK_THROWS_WITH(run_server(run, summary), Catch::Matchers::Contains("2 consumers"));
    crowd.join();
    CHECK(publisher.published_frames() == 0);
}

TEST_CASE("serial coupling computes frame f with agents f, parallel coupling with agents f - 1", "[server][agents]") {
    const std::uint32_t lag = GENERATE(0U, 1U);
    Scene scene = short_scene(30, 0.2);
    scene.coupling->agents_stream = lag == 1 ? AgentsStream::parallel : AgentsStream::serial;
    const std::string session = session_of_its_own();
    Counter model;
    shm::Publisher publisher(session, stream_info(scene, model), patient());
    CHECK(publisher.info().coupling_lag == lag);
    CrowdThread crowd([&] { walk(session, lag, 1000); });
    RunClock clock(scene, Pace::fast);
    AgentsInlet agents(session, lag, joining());
    ServerSummary summary;
    ServerRun run{model, publisher, clock, &agents};
    run_server(run, summary);
    crowd.join();
    CHECK(crowd.error == nullptr);
    model.agents_before.resize(6);
    const std::vector<std::uint64_t> serial{1, 2, 3, 4, 5, 6}, parallel{0, 1, 2, 3, 4, 5};
    CHECK(model.agents_before == (lag == 0 ? serial : parallel));
    CHECK(agents.frames() == 6 - lag);
    CHECK(agents.hash() != 0);
    for (std::size_t i = 0; i < model.agents_x.size(); ++i) {
        CHECK(model.agents_x[i] == 101 + static_cast<float>(i));
        CHECK(model.agents_ticks[i] == i * frame_ticks);
    }
}

TEST_CASE("a crowd that ends its agents stream ends the run", "[server][agents]") {
    Scene scene = short_scene(30, 100);
    const std::string session = session_of_its_own();
    Counter model;
    shm::Publisher publisher(session, stream_info(scene, model), patient());
    CrowdThread crowd([&] { walk(session, 0, 5); });
    RunClock clock(scene, Pace::fast);
    AgentsInlet agents(session, 0, joining());
    ServerSummary summary;
    run_server({model, publisher, clock, &agents}, summary);
    crowd.join();
    CHECK(crowd.error == nullptr);
    CHECK(summary.crowd_left);
    CHECK(summary.frames == 5);
    CHECK(agents.frames() == 5);
}

TEST_CASE("a crowd with another coupling lag is refused with both values", "[server][agents]") {
    Scene scene = short_scene(30, 1);
    const std::string session = session_of_its_own();
    Counter model;
    shm::Publisher publisher(session, stream_info(scene, model), patient());
    CrowdThread crowd([&] { walk(session, 1, 5); });
    RunClock clock(scene, Pace::fast);
    AgentsInlet agents(session, 0, joining());
    ServerSummary summary;
    CHECK_THROWS_WITH(run_server({model, publisher, clock, &agents}, summary),
                      Catch::Matchers::Contains("coupling lag 1, the scene says 0"));
    crowd.join();
    CHECK(crowd.error != nullptr);
}

TEST_CASE("a signal ends the run before the next frame and the consumers learn it", "[server]") {
    const Scene scene = short_scene(30, 100);
    const std::string session = session_of_its_own();
    Counter model;
    shm::Publisher publisher(session, stream_info(scene, model), patient());
    CrowdThread crowd([&] {
        shm::Subscriber water(session, "crowd", joining());
        while (water.acquire()) water.release();
    });
    RunClock clock(scene, Pace::fast);
    ServerSummary summary;
    ServerRun run{model, publisher, clock};
    int holds = 0;
    run.hold = [&] { ++holds; };
    run.interrupted = [&] { return holds == 4 ? 2 : 0; };
    CHECK_THROWS_WITH(run_server(run, summary), "interrupted by a signal at frame 4");
    crowd.join();
    CHECK(publisher.published_frames() == 3);
    REQUIRE(crowd.error != nullptr);
    CHECK_THROWS_WITH(std::rethrow_exception(crowd.error),
                      Catch::Matchers::Contains("interrupted by a signal at frame 4"));
}

TEST_CASE("a wait for real time that a signal ends does not last", "[server]") {
    const Scene scene = short_scene(0.01, 1000);
    Counter model;
    shm::Publisher publisher(session_of_its_own(), stream_info(scene, model), patient());
    double now = 0;
    RunClock clock(scene, Pace::real_time, {[&] { return now; }, [&](double seconds) { now += seconds; }});
    ServerSummary summary;
    ServerRun run{model, publisher, clock};
    run.consumers = 0;
    run.interrupted = [&] { return now > 50 ? 15 : 0; };  // frame 1 is due after 100 s
    CHECK_THROWS_AS(run_server(run, summary), shm::Error);
    CHECK(now < 51);
}

TEST_CASE("the solved water of a frame is that of its steps", "[server][fluid]") {
    const Scene scene = test::emitter_channel(1.5, 0.98, 5000);
    DfsphModel model(scene);
    FluidWorld world(scene);
    test::FrameArrays arrays(model);
    CHECK(model.capacity() == 5000);
    for (std::uint64_t f = 1; f <= 20; ++f) {
        const shm::Diagnostics d = model.advance_frame({(f - 1) * 100'000, f * 100'000, 3'000'000});
        std::uint32_t steps = 0;
        for (double left = 1.0 / 30; left > 1e-9 / 30; ++steps) left -= world.step(left).dt;
        REQUIRE(d.sub_steps == steps);
    }
    arrays.take(model);
    const Particles& p = world.particles();
    REQUIRE(arrays.count == p.count);
    const std::vector<float> x(p.x.begin(), p.x.begin() + static_cast<std::ptrdiff_t>(p.count));
    CHECK(arrays.x() == x);
}

TEST_CASE("threads make room while others want the processors, and come back", "[fluid][threads]") {
    ThreadChoice threads{.most = 2, .now = 2};
    const auto periods = [&](int number, double waiting) {
        for (int n = 0; n < number; ++n) threads.after_period(waiting);
    };
    periods(100, 0.5);  // the crowd of the same run, busy all the time, on two processors
    CHECK(threads.now == 2);
    periods(1, 1.0);  // another such run
    CHECK(threads.now == 1);
    periods(threads.patience - 1, 0.1);
    CHECK(threads.now == 1);
    periods(1, 0.1);
    CHECK(threads.now == 2);  // a trial
    const int before = threads.patience;
    periods(1, 0.9);
    CHECK(threads.now == 1);
    CHECK(threads.patience == 2 * before);
    periods(1000, 0.9);  // one thread is the least, and trials are rare
    CHECK(threads.patience == ThreadChoice::most_patience);
    periods(ThreadChoice::most_patience + 1, 0.1);
    CHECK(threads.now == 2);

    ThreadChoice many{.most = 16, .now = 16};
    many.after_period(6.2);
    CHECK(many.now == 10);
    many.after_period(40);
    CHECK(many.now == 1);
}

TEST_CASE("the system tells how long threads were ready without a processor", "[fluid][threads]") {
    // More busy threads than processors: some must wait, half of the time if no other program works.
    const double before = time_without_processor();
    REQUIRE(before >= 0);
    std::atomic<bool> work = true;
    std::vector<std::thread> threads;
    for (unsigned n = 0; n < 2 * std::thread::hardware_concurrency(); ++n) {
        threads.emplace_back([&] {
            while (work) {
            }
        });
    }
    double waited = 0;
    for (int n = 0; n < 1000 && waited <= 0.01; ++n) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        waited = time_without_processor() - before;
    }
    work = false;
    for (std::thread& thread : threads) thread.join();
    CHECK(waited > 0.01);
}
