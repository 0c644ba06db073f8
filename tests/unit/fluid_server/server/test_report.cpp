#include <unistd.h>

#include <catch2/catch.hpp>
#include <string>

#include "configs/scene/channel.hpp"
#include "fluid_server/server/report.hpp"
#include "toy_model.hpp"

using namespace wade;
using namespace wade::fluid;

namespace {

// Of a run of 1 h at 30 frames a second after its first 10 s.
std::string line_of(const shm::Diagnostics& d, std::uint32_t particles) {
    Scene scene;
    scene.channel->x = {0, 24};
    scene.frame_rate = 30;
    scene.duration = 3600;
    Toy model(scene);
    shm::Publisher publisher("test-report-" + std::to_string(::getpid()), stream_info(scene, model), {});
    RunClock clock(scene, Pace::fast);
    TimeLeft left(clock.end(), 4e9);
    ServerSummary summary;
    summary.particles = particles;
    summary.last = d;
    for (int f = 0; f < 300; ++f) {
        left.note(clock.next_frame([] {}).end(), 1000.0 * (f + 1), 1e7 * (f + 1));
    }
    return progress_line({model, publisher, clock}, summary, left);
}

}  // namespace

TEST_CASE("a line of progress says time, particles and what is left, and has at most 100 columns", "[server]") {
    shm::Diagnostics d;
    d.last_dt_s = 0.0123;
    const std::string little = line_of(d, 24);
    CHECK_THAT(little, Catch::StartsWith("t 10.0/3600 s  24 particles  0.00 x real time, about "));
    CHECK_THAT(little, Catch::Contains(" to go") && !Catch::Contains("depth"));
    CHECK(little.size() <= 100);

    d.mean_density_error = 0.12345;
    d.divergence_iterations = 4000000000;
    d.density_iterations = 4000000000;
    d.mean_depth_m = 1234.5;
    d.mean_speed_m_s = 1234.5;
    const std::string much = line_of(d, 4000000000);
    CHECK_THAT(much, Catch::StartsWith("t 10.0/3600 s  4000000000 particles  0.00 x real time, about "));
    CHECK_THAT(much, Catch::Contains(" to go"));
    CHECK(much.size() <= 100);
}
