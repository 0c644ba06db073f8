#include <catch2/catch.hpp>

#include "fluid_server/kinematic/velocity_profile.hpp"

using namespace wade;
using namespace wade::fluid;

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
