// What the crowd sees of a scale model: positions, speeds and masses of the world, on the world's clock.

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "crowd_client/water/water_view.hpp"
#include "tools/splishsplash/model_units.hpp"

using namespace wade;
using namespace wade::splishsplash;

namespace {

// 1/10 scale, z mirrored, time ten times longer: a river that moves at the model's figures in m/s.
ModelUnits tenth() {
    return {10, 10, {0, 0, 0}, {1, 2, -3}, 300};
}

struct OneParticle {
    std::vector<float> mass{0}, vx{0}, vy{0}, vz{0}, px{0}, py{0}, pz{0};

    [[nodiscard]] shm::FrameFields slot() {
        shm::FrameFields fields;
        fields.frame = 1;
        fields.mass = mass;
        fields.vx = vx, fields.vy = vy, fields.vz = vz;
        fields.px = px, fields.py = py, fields.pz = pz;
        return fields;
    }
    [[nodiscard]] shm::Frame frame() const {
        shm::Frame frame;
        frame.frame = 1;
        frame.count = 1;
        frame.mass = mass;
        frame.vx = vx, frame.vy = vy, frame.vz = vz;
        frame.px = px, frame.py = py, frame.pz = pz;
        return frame;
    }
};

struct Seen {
    double mass, x, z, vx, vz;
};

// Through the crowd's own view of a frame.
Seen seen_by_crowd(const ModelUnits& units, const ModelParticle& particle) {
    OneParticle frame;
    store(units, particle, frame.slot(), 0);
    const crowd::WaterView view = crowd::ground_view(frame.frame(), stream_info(units, 1, 0.025, 1000));
    return {static_cast<double>(view.mass[0]), view.origin_x + view.scale_x * static_cast<double>(view.px[0]),
            view.origin_z + view.scale_z * static_cast<double>(view.pz[0]),
            view.scale_x * static_cast<double>(view.vx[0]), view.scale_z * static_cast<double>(view.vz[0])};
}

double frame_seconds(const shm::StreamInfo& info) {
    return static_cast<double>(info.ticks_per_frame) / static_cast<double>(info.ticks_per_second);
}

}  // namespace

TEST_CASE("a particle of a tenth-scale model with mirrored z is seen at its place in the world") {
    const Seen seen = seen_by_crowd(tenth(), {0.1, {7.5F, 0.05F, -2.5F}, {}});
    CHECK(seen.x == Approx(75));
    CHECK(seen.z == Approx(25));
}

TEST_CASE("with a time scale equal to the length scale a velocity is seen with the model's figures, z mirrored") {
    const Seen seen = seen_by_crowd(tenth(), {0.1, {}, {-1.5F, 0, 0.25F}});
    CHECK(seen.vx == Approx(-1.5));
    CHECK(seen.vz == Approx(-0.25));
}

TEST_CASE("a particle of 0.1 kg at a tenth of the scale is seen with 100 kg") {
    CHECK(seen_by_crowd(tenth(), {0.1, {}, {}}).mass == Approx(100));
}

TEST_CASE("particles are seen to move between frames as far as their velocity says, at any time scale") {
    for (const double time_scale : {1.0, std::sqrt(10.0), 10.0}) {
        CAPTURE(time_scale);
        ModelUnits units = tenth();
        units.time_scale = time_scale;
        const float speed = -1.5F;
        const float way = speed / static_cast<float>(units.frame_rate);  // in a frame of the model
        const Seen before = seen_by_crowd(units, {0.1, {5, 0, 0}, {speed, 0, 0}});
        const Seen after = seen_by_crowd(units, {0.1, {5 + way, 0, 0}, {speed, 0, 0}});
        const double frame = frame_seconds(stream_info(units, 1, 0.025, 1000));
        CHECK(after.x - before.x == Approx(before.vx * frame).epsilon(1e-4));
    }
}

TEST_CASE("300 frames a second of a model whose second lasts 10 s are 30 frames a second of the world") {
    CHECK(frame_seconds(stream_info(tenth(), 1, 0.025, 1000)) == Approx(1.0 / 30).epsilon(1e-9));
}

TEST_CASE("the header states the particle radius in metres") {
    CHECK(stream_info(tenth(), 1, 0.025, 1000).particle_radius == Approx(0.25));
}

TEST_CASE("the tick of a frame is its time, not its number") {
    const double third_frame_late = (90 + 1.0 / 3) / 300;
    CHECK(tick_of_time(tenth(), 0.3, 90) == 90 * ticks_per_frame);
    CHECK(tick_of_time(tenth(), third_frame_late, 90) == 90'333'333);
}

TEST_CASE("12,000 steps of a frame each are 12,000 whole frames, although a single-precision clock drifts") {
    const float step = 1.0F / 300;
    float drifting = 0;
    ModelClock clock;
    bool whole = true;
    for (std::uint64_t frame = 1; frame <= 12'000; ++frame) {
        drifting += step;
        const double time = clock.advance(static_cast<double>(drifting), static_cast<double>(step));
        whole = whole && tick_of_time(tenth(), time, frame) == frame * ticks_per_frame;
    }
    CHECK(whole);
    CHECK(std::abs(static_cast<double>(drifting) - 40) > 1.0 / 300);
}

TEST_CASE("with three steps a frame, of which the first is exported, frames lie a whole frame apart") {
    const float step = 1.0F / 900;
    float drifting = 0;
    ModelClock clock;
    for (std::uint64_t n = 1; n <= 6'000; ++n) {
        drifting += step;
        if (n % 3 != 1) continue;
        const double time = clock.advance(static_cast<double>(drifting), static_cast<double>(step));
        const auto ticks = static_cast<double>(tick_of_time(tenth(), time, n / 3 + 1));
        REQUIRE(std::abs(ticks - static_cast<double>(n) / 3 * static_cast<double>(ticks_per_frame)) < 100);
    }
}

TEST_CASE("steps of changing length are taken from the simulator's clock") {
    ModelClock clock;
    CHECK(clock.advance(0.002, 0.002) == Approx(0.002).epsilon(1e-9));
    CHECK(clock.advance(0.0055, 0.0015) == Approx(0.0055).epsilon(1e-9));
    CHECK(clock.advance(0.0065, 0.001) == Approx(0.0065).epsilon(1e-9));
}

TEST_CASE("a stream that is switched on in the middle of a simulation starts one step after its own zero") {
    ModelClock clock;
    CHECK(clock.advance(5.0, 0.01) == 0.01);
    CHECK(clock.advance(5.01, 0.01) == 0.02);
}

TEST_CASE("a simulation whose steps are longer than a frame is refused at its second frame") {
    CHECK_NOTHROW(tick_of_time(tenth(), 2.0 / 300, 1));
    CHECK_THROWS_WITH(tick_of_time(tenth(), 4.0 / 300, 2), Catch::Contains("time step"));
    CHECK_THROWS(tick_of_time(tenth(), std::nan(""), 1));
}

TEST_CASE("units out of range are refused with the key and the range") {
    ModelUnits units = tenth();
    units.time_scale = 0;
    CHECK_THROWS_WITH(check(units), Catch::Contains("time_scale is 0") && Catch::Contains("1e-06 to 1e+06"));
    units = tenth();
    units.axes = {1, 1, -3};
    CHECK_THROWS_WITH(check(units), Catch::Contains("axes is [1, 1, -3]"));
    CHECK_NOTHROW(check(tenth()));
}
