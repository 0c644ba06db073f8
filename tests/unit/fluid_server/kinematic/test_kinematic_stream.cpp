// The prescribed stream and its profile.

#include <omp.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "fluid_server/kinematic/kinematic_stream.hpp"
#include "fluid_server/kinematic/velocity_profile.hpp"
#include "frame_arrays.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;

namespace kinematic_stream_test {

namespace {

constexpr std::uint64_t ticks_per_second = 3'000'000;
constexpr std::uint64_t ticks_per_frame = 100'000;

Scene stream_scene(Flow flow, InitialRiver river) {
    Scene scene = test::emitter_channel(1.5, 9.81, 10000);
    scene.fluid->model = wade::ModelKind::kinematic;
    scene.channel->x = {20, 60};
    scene.channel->z = {11.5, 20};
    scene.channel->flow = flow;
    scene.channel->initial_river = river;
    return scene;
}
Scene dry_scene() {
    return stream_scene(Flow::emitter, InitialRiver::dry);
}
Scene filled_scene() {
    return stream_scene(Flow::emitter, InitialRiver::filled);
}
Scene round_scene() {
    return stream_scene(Flow::recirculating, InitialRiver::filled);
}

FrameInterval frame(std::uint64_t f) {
    return {(f - 1) * ticks_per_frame, f * ticks_per_frame, ticks_per_second};
}

test::FrameArrays frame_at(const Scene& scene, std::uint64_t f, shm::Diagnostics* diagnostics = nullptr) {
    KinematicStream stream(scene);
    const shm::Diagnostics d = stream.advance_frame(frame(f));
    if (diagnostics != nullptr) *diagnostics = d;
    test::FrameArrays arrays(stream);
    arrays.take(stream);
    return arrays;
}

double bed_area(const Scene& scene) {
    return scene.channel->x.length() * scene.channel->z.length();
}

}  // namespace

TEST_CASE("a recirculating kinematic stream holds the mass of its depth to half a particle", "[fluid][kinematic]") {
    for (const double depth : {0.5, 0.7, 1.0, 1.3}) {
        Scene scene = round_scene();
        scene.channel->depth = depth;
        const double wanted = 1000 * depth * bed_area(scene);
        const double particle = 1000 * std::pow(scene.fluid->particle_spacing, 3);
        INFO(depth);
        CHECK(std::abs(frame_at(scene, 7).mass() - wanted) <= 0.501 * particle);
    }
}

TEST_CASE("a kinematic stream through a channel holds the mass of its depth in the mean over time",
          "[fluid][kinematic]") {
    for (const double depth : {0.5, 0.7, 1.0, 1.3}) {
        Scene scene = filled_scene();
        scene.channel->depth = depth;
        KinematicStream stream(scene);
        test::FrameArrays arrays(stream);
        double mass = 0;
        for (std::uint64_t f = 1; f <= 400; ++f) {
            stream.advance_frame(frame(f));
            arrays.take(stream);
            mass += arrays.mass() / 400;
        }
        INFO(depth);
        CHECK(mass == Approx(1000 * depth * bed_area(scene)).epsilon(1e-3));
    }
}

TEST_CASE("the front of a dry start is at transport factor times velocity times time", "[fluid][kinematic]") {
    Scene scene = dry_scene();
    scene.fluid->kinematic.transport_factor = 2.6;
    for (const std::uint64_t f : {30U, 90U, 200U}) {
        const auto x = frame_at(scene, f).x();
        const double front = 60 - 2.6 * 1.5 * static_cast<double>(f) / 30;
        const double foremost = static_cast<double>(*std::min_element(x.begin(), x.end()));
        INFO(f);
        CHECK(foremost >= front - 1e-4);
        CHECK(foremost <= front + scene.fluid->particle_spacing);  // the nearest of some forty first cells
    }
}

TEST_CASE("nothing of a dry start is there before it enters, nothing stays when it has passed the end",
          "[fluid][kinematic]") {
    const Scene scene = dry_scene();
    KinematicStream stream(scene);
    test::FrameArrays arrays(stream);
    arrays.take(stream);
    CHECK(arrays.count == 0);
    for (std::uint64_t f = 1; f <= 1500; ++f) {
        const shm::Diagnostics d = stream.advance_frame(frame(f));
        arrays.take(stream);
        for (const float x : arrays.x()) REQUIRE((x >= 20 && x <= 60));
        // What has come through the opening is there or was recycled; 50 cells may be a particle ahead or behind.
        const double entered = 1.5 * static_cast<double>(f) / 30 * 8.5;  // m3
        const double particles = static_cast<double>(arrays.count) + static_cast<double>(d.recycled_particles);
        REQUIRE(std::abs(particles * std::pow(scene.fluid->particle_spacing, 3) - entered) < 4);
    }
    CHECK(arrays.count > 0);
}

TEST_CASE("a kinematic stream publishes the velocity without the transport factor", "[fluid][kinematic]") {
    Scene scene = filled_scene();
    scene.fluid->kinematic.transport_factor = 2.6;
    shm::Diagnostics d;
    const auto particles = frame_at(scene, 12, &d).particles();
    CHECK(std::all_of(particles[1].begin(), particles[1].end(), [](float v) { return v == -1.5F; }));
    CHECK(std::all_of(particles[2].begin(), particles[2].end(), [](float v) { return v == 0; }));
    CHECK(d.mean_speed_m_s == Approx(1.5));
    CHECK(d.mean_depth_m == Approx(1.0).epsilon(0.01));
}

TEST_CASE("the layers of a logarithmic stream have its velocity as their mean and move each at their own",
          "[fluid][kinematic]") {
    Scene scene = round_scene();
    scene.fluid->particle_spacing = 0.25;
    scene.fluid->max_particles = 100000;
    scene.fluid->kinematic.profile = VelocityProfile::logarithmic;
    scene.fluid->kinematic.transport_factor = 2;
    shm::Diagnostics d;
    const auto before = frame_at(scene, 1).particles();
    const auto after = frame_at(scene, 2, &d).particles();
    CHECK(d.mean_speed_m_s == Approx(1.5).epsilon(1e-4));
    std::set<float> heights, velocities;
    for (std::size_t i = 0; i < before[0].size(); ++i) {
        heights.insert(before[5][i]);
        velocities.insert(before[1][i]);
        double moved = static_cast<double>(before[4][i] - after[4][i]);
        if (moved < 0) moved += 40;
        REQUIRE(moved == Approx(2 * static_cast<double>(-before[1][i]) / 30).margin(1e-5));
    }
    CHECK(heights == std::set<float>{0.125F, 0.375F, 0.625F, 0.875F});
    CHECK(velocities.size() == 4);
}

TEST_CASE("a recirculating kinematic stream comes back after a round", "[fluid][kinematic]") {
    // 40 m at 1.6 m/s are 25 s or 750 frames.
    Scene scene = round_scene();
    scene.channel->velocity = 1.6;
    const auto once = frame_at(scene, 10).particles();
    const auto again = frame_at(scene, 760).particles();
    REQUIRE(once[0].size() == again[0].size());
    for (std::size_t i = 0; i < once[0].size(); ++i) {
        REQUIRE(again[4][i] == Approx(once[4][i]).margin(1e-4));
        REQUIRE(again[6][i] == once[6][i]);
        REQUIRE((once[4][i] >= 20 && once[4][i] <= 60));
    }
}

TEST_CASE("a frame of a kinematic stream is a function of its tick alone", "[fluid][kinematic]") {
    for (const Scene& scene : {dry_scene(), filled_scene(), round_scene()}) {
        KinematicStream stream(scene);
        shm::Diagnostics step_by_step, at_once;
        for (std::uint64_t f = 1; f <= 900; ++f) step_by_step = stream.advance_frame(frame(f));
        test::FrameArrays arrays(stream);
        arrays.take(stream);
        CHECK(arrays.particles() == frame_at(scene, 900, &at_once).particles());
        CHECK(step_by_step.recycled_particles == at_once.recycled_particles);

        // Frames of any length lead to the same positions.
        KinematicStream uneven(scene);
        uneven.advance_frame({0, 12'345'678, ticks_per_second});
        uneven.advance_frame({12'345'678, 900 * ticks_per_frame, ticks_per_second});
        test::FrameArrays same(uneven);
        same.take(uneven);
        CHECK(same.particles() == arrays.particles());
    }
}

TEST_CASE("a kinematic stream is the same for any number of threads and another for another seed",
          "[fluid][kinematic]") {
    Scene scene = filled_scene();
    scene.fluid->particle_spacing = 0.25;
    scene.fluid->max_particles = 100000;
    const int threads = omp_get_max_threads();
    omp_set_num_threads(1);
    const auto alone = frame_at(scene, 30).particles();
    omp_set_num_threads(4);
    const auto together = frame_at(scene, 30).particles();
    omp_set_num_threads(threads);
    REQUIRE(alone[0].size() > 4096);  // enough to be shared among threads
    CHECK(alone == together);
    scene.seed = 2;
    CHECK(alone != frame_at(scene, 30).particles());
}

TEST_CASE("particles that pass the end of a filled stream are counted as recycled", "[fluid][kinematic]") {
    const Scene scene = filled_scene();
    shm::Diagnostics d;
    frame_at(scene, 300, &d);
    const double passed = 1.5 * 10 * 8.5 / std::pow(scene.fluid->particle_spacing, 3);
    CHECK(static_cast<double>(d.recycled_particles) == Approx(passed).margin(20));
}

TEST_CASE("each particle of a kinematic stream is anywhere in its cell", "[fluid][kinematic]") {
    Scene scene = round_scene();
    const auto particles = frame_at(scene, 1).particles();
    const double strip_width = 8.5 / 18;  // the strips are about as wide as the spacing of 0.46 m
    std::vector<double> along, across;    // of the first strip of the lowest layer; of all
    for (std::size_t i = 0; i < particles[0].size(); ++i) {
        const double z = static_cast<double>(particles[6][i]) - 11.5;
        across.push_back(z);
        if (particles[5][i] < 0.3F && z < strip_width) along.push_back(static_cast<double>(particles[4][i]));
    }
    std::sort(across.begin(), across.end());
    std::sort(along.begin(), along.end());
    REQUIRE(along.size() > 60);
    // The distance of two uniform positions in neighbouring cells has a variance of 1/6 of the squared cell size.
    const double cell = 40 / static_cast<double>(along.size());
    double variance = 0;
    for (std::size_t i = 1; i < along.size(); ++i) {
        const double deviation = along[i] - along[i - 1] - cell;
        variance += deviation * deviation / static_cast<double>(along.size() - 1);
    }
    CHECK(variance / (cell * cell) == Approx(1.0 / 6).margin(0.06));
    // The width has no gap.
    double gap = std::max(across.front(), 8.5 - across.back());
    for (std::size_t i = 1; i < across.size(); ++i) gap = std::max(gap, across[i] - across[i - 1]);
    CHECK(gap < 0.05);
}

namespace {

constexpr double lattice_strip = 8.5 / 19;  // m, of 0.4642 m of spacing and layers of 0.5 m

// The recirculating stream with two layers of particles in a lattice, as 0.46 m makes of 1 m.
Scene lattice_scene(double jitter) {
    Scene scene = round_scene();
    scene.fluid->kinematic.arrangement = Arrangement::lattice;
    scene.fluid->kinematic.jitter = jitter;
    return scene;
}

// Returns positions of particles across their strips, in cells: of all layers below 0.5 m, or of all above.
std::vector<double> across_of_layer(const Scene& scene, bool upper) {
    const auto particles = frame_at(scene, 5).particles();
    std::vector<double> across;
    for (std::size_t i = 0; i < particles[0].size(); ++i) {
        if ((particles[5][i] > 0.5F) != upper) continue;
        const double strips = (static_cast<double>(particles[6][i]) - 11.5) / lattice_strip;
        across.push_back(strips - std::floor(strips));
    }
    return across;
}

}  // namespace

TEST_CASE("a lattice without jitter has one distance along and its layers half a cell apart", "[fluid][kinematic]") {
    const Scene scene = lattice_scene(0);
    for (const double place : across_of_layer(scene, false)) REQUIRE(place == Approx(0.25).margin(1e-4));
    for (const double place : across_of_layer(scene, true)) REQUIRE(place == Approx(0.75).margin(1e-4));
    const auto particles = frame_at(scene, 5).particles();
    std::vector<double> along;  // of the first strip of the lowest layer
    for (std::size_t i = 0; i < particles[0].size(); ++i) {
        if (particles[5][i] < 0.5F && particles[6][i] < 11.5F + static_cast<float>(lattice_strip)) {
            along.push_back(static_cast<double>(particles[4][i]));
        }
    }
    std::sort(along.begin(), along.end());
    REQUIRE(along.size() > 60);
    const double cell = 40 / static_cast<double>(along.size());
    for (std::size_t i = 1; i < along.size(); ++i) REQUIRE(along[i] - along[i - 1] == Approx(cell).margin(1e-4));
}

TEST_CASE("the particles of a lattice deviate by up to half of the jitter", "[fluid][kinematic]") {
    double least = 1, most = 0;
    for (const double place : across_of_layer(lattice_scene(0.4), false)) {
        least = std::min(least, place);
        most = std::max(most, place);
    }
    // The outermost of some 900 uniform numbers are within a hundredth of the ends.
    CHECK(least == Approx(0.05).margin(0.005));
    CHECK(most == Approx(0.45).margin(0.005));
}

TEST_CASE("a lattice keeps the mass of its depth and its cells whatever its jitter", "[fluid][kinematic]") {
    for (const double jitter : {0.0, 0.5, 0.8, 1.0}) {
        Scene scene = lattice_scene(jitter);
        scene.channel->flow = Flow::emitter;
        KinematicStream stream(scene);
        test::FrameArrays arrays(stream);
        double mass = 0;
        for (std::uint64_t f = 1; f <= 400; ++f) {
            stream.advance_frame(frame(f));
            arrays.take(stream);
            mass += arrays.mass() / 400;
            const auto particles = arrays.particles();
            for (const float x : particles[4]) REQUIRE((x >= 20 && x <= 60));
            for (const float z : particles[6]) REQUIRE((z >= 11.5F && z <= 20));
        }
        INFO(jitter);
        // All strips change their number of particles at once, so the mean of 400 frames is not as exact as at random.
        CHECK(mass == Approx(1000 * bed_area(scene)).epsilon(5e-3));
    }
}

}  // namespace kinematic_stream_test

namespace velocity_profile_test {

namespace {

// Mean over the heights by the midpoint rule, which does not know the integral in closed form.
double sampled_mean(const ProfiledStream& stream, double bottom, double top) {
    const int n = 200000;
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += velocity_at(stream, bottom + (top - bottom) * (i + 0.5) / n);
    return sum / n;
}

}  // namespace

TEST_CASE("the logarithmic profile has the given velocity as its mean over the depth", "[fluid][kinematic]") {
    for (const double roughness : {0.0005, 0.005, 0.1, 1.0}) {
        for (const double depth : {0.2, 1.0, 4.0}) {
            const ProfiledStream stream{VelocityProfile::logarithmic, depth, 1.5, roughness};
            INFO(roughness << " " << depth);
            CHECK(sampled_mean(stream, 0, depth) == Approx(1.5).epsilon(1e-5));
        }
    }
}

TEST_CASE("the mean between two heights is the integral of the profile", "[fluid][kinematic]") {
    const ProfiledStream stream{VelocityProfile::logarithmic, 1, 2, 0.005};
    CHECK(mean_velocity_between(stream, 0, 1) == Approx(2).epsilon(1e-12));
    CHECK(mean_velocity_between(stream, 0, 0.5) == Approx(sampled_mean(stream, 0, 0.5)).epsilon(1e-5));
    CHECK(mean_velocity_between(stream, 0.6, 0.7) == Approx(sampled_mean(stream, 0.6, 0.7)).epsilon(1e-5));
}

TEST_CASE("the logarithmic profile is at rest on the bed and grows upwards as the law of the wall",
          "[fluid][kinematic]") {
    const double z0 = 0.01;
    const ProfiledStream stream{VelocityProfile::logarithmic, 1, 1, z0};
    CHECK(velocity_at(stream, 0) == 0);
    // ln(1 + y/z_0) grows by ln 2 from y + z_0 to twice that.
    const double step = velocity_at(stream, 2 * (0.1 + z0) - z0) - velocity_at(stream, 0.1);
    CHECK(velocity_at(stream, 2 * (0.3 + z0) - z0) - velocity_at(stream, 0.3) == Approx(step));
    CHECK(step > 0);
}

TEST_CASE("the uniform profile is the same at every height", "[fluid][kinematic]") {
    const ProfiledStream stream{VelocityProfile::uniform, 1, 1.5, 0.005};
    CHECK(velocity_at(stream, 0) == 1.5);
    CHECK(velocity_at(stream, 1) == 1.5);
    CHECK(mean_velocity_between(stream, 0, 0.5) == 1.5);
}

}  // namespace velocity_profile_test
