#include <catch2/catch.hpp>
#include <limits>

#include "crowd_client/session/progress.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::one_agent_scene;

namespace {

shm::Frame solved_frame(std::uint32_t particles) {
    shm::Frame frame;
    frame.count = particles;
    frame.diagnostics.sub_steps = 3;
    frame.diagnostics.density_iterations = 7;
    frame.diagnostics.divergence_iterations = 4;
    frame.diagnostics.mean_density_error = 0.0004;
    frame.diagnostics.max_density_error = 0.01;
    return frame;
}

CrowdWorld crowd_at(double time) {
    Scene scene = one_agent_scene(10, 25, 75, 50, 0.2);
    scene.duration = 100;
    CrowdWorld crowd = make_crowd(scene);
    crowd.steps = static_cast<std::uint64_t>(time * 30);
    return crowd;
}

}  // namespace

TEST_CASE("Progress shows time, people and the health of the water") {
    CHECK(progress_line(crowd_at(10), solved_frame(26880), 2, 45) ==
          "t 10.0/100 s  active 1 arrived 0 dead 0  26880 particles, error 0.040 %  2.00 x real, 45 s to go");
    CHECK_THAT(progress_line(crowd_at(10), solved_frame(26880), 0, {}),
               Catch::Contains("error 0.040 %, 4+7 iterations") && !Catch::Contains("real"));
    CHECK_THAT(progress_line(crowd_at(10), solved_frame(26880), 0.5, 180), Catch::Contains("0.50 x real, 3 min to go"));
    shm::Frame given = solved_frame(10);
    given.diagnostics = {};
    given.diagnostics.mean_depth_m = 0.75;
    CHECK_THAT(progress_line(crowd_at(10), given, 0, {}), Catch::Contains("10 particles, depth 0.75 m"));
}

TEST_CASE("No line of progress has more than 100 columns, however large its numbers are") {
    CrowdWorld crowd = crowd_at(10);
    crowd.scene.duration = 1e9;
    crowd.steps = 29'999'999'999;
    crowd.arrived = crowd.dead = 1'000'000;
    shm::Frame frame = solved_frame(std::numeric_limits<std::uint32_t>::max());
    frame.diagnostics.mean_density_error = 1e9;
    frame.diagnostics.density_iterations = frame.diagnostics.divergence_iterations = 100'000;
    for (const double pace : {0.0, 1e-9, 1.0, 1e9}) {
        CHECK(progress_line(crowd, frame, pace, 1e15).size() <= 100);
        CHECK(progress_line({100'000, 100'000, 100'000'000, 1e9}, frame, pace).size() <= 100);
    }
    // What matters most stays.
    CHECK_THAT(progress_line(crowd, frame, 1, 1e15), Catch::Contains("arrived 1000000") && Catch::Contains("to go"));
}

TEST_CASE("Times of the stages are shown for who counted them") {
    CrowdWorld crowd = crowd_at(0);
    CHECK(step_times_text(crowd).empty());
    crowd.times = std::make_shared<StepTimes>();
    for (int i = 0; i < 3; ++i) step(crowd, {});
    CHECK(crowd.times->steps == 3);
    const std::string text = step_times_text(crowd);
    for (const std::string_view name : stage_names()) CHECK_THAT(text, Catch::Contains(std::string(name)));
    CHECK(crowd.times->seconds.size() == stage_names().size());
}
