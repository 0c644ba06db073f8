// The client and a producer of a uniform stream over real shared memory, one thread each.

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <exception>
#include <thread>

#include "configs/errors/exit_code.hpp"
#include "crowd_client/session/frame_time.hpp"
#include "crowd_client/session/run_crowds.hpp"
#include "made_up_water.hpp"
#include "shm_protocol/publisher.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::one_agent_scene;

namespace {

std::string session_of_crowd(const char* name) {
    return "wade-test-crowd-" + std::to_string(::getpid()) + "-" + name;
}

shm::StreamInfo stream_info(const MadeUpWater& water) {
    shm::StreamInfo info;
    info.producer_name = "uniform";
    info.capacity = static_cast<std::uint32_t>(water.mass.size());
    info.scene_hash = 42;
    return info;
}

void fill(const shm::FrameFields& fields, const MadeUpWater& water) {
    const auto put = [](std::span<float> to, const std::vector<float>& from) {
        std::copy(from.begin(), from.end(), to.begin());
    };
    put(fields.mass, water.mass);
    put(fields.vx, water.vx);
    put(fields.vy, water.vy);
    put(fields.vz, water.vz);
    put(fields.px, water.px);
    put(fields.py, water.py);
    put(fields.pz, water.pz);
}

// Publishes the same water frame after frame until the client leaves, or `frames` of them, the last one as final.
void produce(const std::string& session, const shm::StreamInfo& info, const MadeUpWater& water, std::uint64_t frames) {
    shm::Publisher publisher(session, info);
    publisher.wait_for_consumers(1);
    for (std::uint64_t f = 1; f <= frames; ++f) {
        const auto fields = publisher.begin_frame();
        if (!fields) return publisher.close();
        fill(*fields, water);
        publisher.end_frame(static_cast<std::uint32_t>(water.mass.size()), {}, f == frames);
    }
    publisher.close();
}

// A producer on a thread of its own; its error, if any, is kept.
class ProducerThread {
 public:
    template <typename... Arguments>
    explicit ProducerThread(Arguments... arguments)
        : thread_([this, arguments...] {
              try {
                  produce(arguments...);
              } catch (...) {
                  error = std::current_exception();
              }
          }) {}
    ~ProducerThread() { join(); }
    ProducerThread(const ProducerThread&) = delete;
    ProducerThread& operator=(const ProducerThread&) = delete;
    void join() {
        if (thread_.joinable()) thread_.join();
    }
    std::exception_ptr error;

 private:
    std::thread thread_;
};

}  // namespace

TEST_CASE("Over shared memory, one agent in a uniform stream moves at the velocity of Eq. 9", "[eq9]") {
    const std::string session = session_of_crowd("eq9");
    const double d = 0.25;
    const double v_f = -1.5;
    const MadeUpWater stream = testing::uniform_water(70, 90, 20, 35, 1, d, v_f, 0);
    Scene scene = one_agent_scene(80, 25, 75, 50, 0.2);
    scene.duration = 2;
    CrowdRun one{.crowd = make_crowd(scene)};
    CrowdWorld& crowd = one.crowd;
    ProducerThread producer(session, stream_info(stream), stream, std::uint64_t{1000});
    const std::unique_ptr<FrameSource> source = join_session(session, 42, FrameMode::lockstep, {});
    CHECK(source->info().producer_name == "uniform");

    Vector2d before = crowd.agents.position[0];
    int checked = 0;
    RunHooks hooks;
    hooks.on_step = [&](std::size_t, const WaterView&) {
        double water_mass = 0;
        for (std::size_t k = 0; k < stream.mass.size(); ++k) {
            const double dx = static_cast<double>(stream.px[k]) - before.x();
            const double dz = static_cast<double>(stream.pz[k]) - before.y();
            if (std::hypot(dx, dz) < 0.25) water_mass += 1000 * d * d * d;
        }
        REQUIRE(water_mass > 0);
        const Vector2d walking = crowd.walking[0];
        const Vector2d v = (crowd.agents.position[0] - before) / crowd.dt;
        REQUIRE(v.x() == Approx((65 * walking.x() + 0.2 * water_mass * v_f) / (65 + 0.2 * water_mass)).margin(1e-5));
        REQUIRE(v.y() == Approx(65 * walking.y() / (65 + 0.2 * water_mass)).margin(1e-5));
        before = crowd.agents.position[0];
        ++checked;
    };
    const RunSummary& summary = one.summary;
    run_crowds({&one, 1}, *source, hooks);
    CHECK(checked == 60);
    CHECK(summary.status == "completed");
    CHECK(summary.frame_hash != 0);
    producer.join();
    CHECK(producer.error == nullptr);  // the client said goodbye
}

TEST_CASE("A stream with another frame rate than the scene's is taken by its ticks") {
    const std::string session = session_of_crowd("rate");
    const MadeUpWater water = testing::uniform_water(0, 1, 0, 1, 0.5, 0.5, 0, 0);
    shm::StreamInfo info = stream_info(water);
    info.ticks_per_second = 20;
    ProducerThread producer(session, info, water, std::uint64_t{40});
    const std::unique_ptr<FrameSource> source = join_session(session, 42, FrameMode::lockstep, {});
    Scene scene = one_agent_scene(80, 25, 75, 50, 0.2);
    scene.duration = 2;
    CHECK_THAT(rate_note(scene, source->info()),
               Catch::Contains("20 frames a second") && Catch::Contains("/frame_rate_hz 30"));
    CrowdRun one{.crowd = make_crowd(scene)};
    CrowdWorld& crowd = one.crowd;
    const RunSummary& summary = one.summary;
    run_crowds({&one, 1}, *source);
    producer.join();
    CHECK(producer.error == nullptr);
    CHECK(summary.status == "completed");
    CHECK(summary.frames == 40);
    CHECK(crowd.steps == 60);
}

TEST_CASE("A client of the latest frames walks all steps and is not waited for") {
    const std::string session = session_of_crowd("latest");
    const MadeUpWater water = testing::uniform_water(0, 1, 0, 1, 0.5, 0.5, 0, 0);
    shm::Publisher publisher(session, stream_info(water));
    const std::unique_ptr<FrameSource> source = join_session(session, 42, FrameMode::latest, {});
    CHECK_FALSE(source->in_lockstep());
    Scene scene = one_agent_scene(80, 25, 75, 50, 0.2);
    scene.duration = 1;
    CrowdRun one{.crowd = make_crowd(scene)};
    CrowdWorld& crowd = one.crowd;
    const RunSummary& summary = one.summary;
    RunHooks hooks;
    std::uint64_t sent = 0;
    // Before each frame that the client takes, the producer sends three without waiting.
    hooks.before_frame = [&] {
        for (int i = 0; i < 3; ++i) {
            const auto fields = publisher.begin_frame();
            REQUIRE(fields);
            fill(*fields, water);
            ++sent;
            publisher.end_frame(static_cast<std::uint32_t>(water.mass.size()), {}, sent == 30);
        }
    };
    run_crowds({&one, 1}, *source, hooks);
    CHECK(summary.status == "completed");
    CHECK(summary.frames == 10);
    CHECK(summary.dropped_frames == 18);  // two before each frame but the first one taken
    CHECK(summary.frame_hash == 0);
    CHECK(crowd.steps == 30);
    publisher.close();
}

TEST_CASE("A client that gives up tells the producer the reason") {
    const std::string session = session_of_crowd("giveup");
    const MadeUpWater water = testing::uniform_water(0, 1, 0, 1, 0.5, 0.5, 0, 0);
    ProducerThread producer(session, stream_info(water), water, std::uint64_t{1000});
    const std::unique_ptr<FrameSource> source = join_session(session, 42, FrameMode::lockstep, {});
    CrowdRun one{.crowd = make_crowd(one_agent_scene(80, 25, 75, 50, 0.2))};
    RunHooks hooks;
    hooks.on_frame = [](const shm::Frame& frame) {
        if (frame.frame == 3) throw RunError(ExitCode::unexpected, "no space left on the device of 'x'");
    };
    CHECK_THROWS_AS(run_crowds({&one, 1}, *source, hooks), RunError);
    producer.join();
    REQUIRE(producer.error);
    CHECK_THROWS_WITH(std::rethrow_exception(producer.error), Catch::Contains("no space left"));
}
