// Each force alone, of two particles, against its formula.

#include <catch2/catch.hpp>
#include <cmath>

#include "flock_pair.hpp"

using namespace wade;
using namespace wade::fluid;
using namespace wade::fluid::test;

namespace {

// Single precision, and distances of zero that count as 1e-6 of the radius.
Approx about(double value) {
    return Approx(value).epsilon(1e-4).margin(1e-5);
}
void check_vector(const Vec3& a, double x, double y, double z) {
    CHECK(static_cast<double>(a[0]) == about(x));
    CHECK(static_cast<double>(a[1]) == about(y));
    CHECK(static_cast<double>(a[2]) == about(z));
}

const Vec3 here{10, 10, 10};
const Vec3 still{0, 0, 0};

}  // namespace

TEST_CASE("separation is weight ((radius / r)^2 - 1), apart, bounded, nothing beyond the radius", "[steering]") {
    steering::Settings s = quiet_settings();
    s.separation = 2;
    auto a = accelerations({{here, {10.6F, 10, 10}}, {still, still}}, s);
    const double expected = 2 * (1 / 0.36 - 1);
    check_vector(a[0], -expected, 0, 0);
    check_vector(a[1], expected, 0, 0);
    a = accelerations({{here, {10, 10.48F, 10.64F}}, {still, still}}, s);  // r = 0.8
    const double at = 2 * (1 / 0.64 - 1);
    check_vector(a[0], 0, -0.6 * at, -0.8 * at);
    check_vector(accelerations({{here, {11.01F, 10, 10}}, {still, still}}, s)[0], 0, 0, 0);
    const double most = 2 * (1 / (0.3 * 0.3) - 1);
    check_vector(accelerations({{here, {10.01F, 10, 10}}, {still, still}}, s)[1], most, 0, 0);
    // Two particles at the same position have no direction.
    check_vector(accelerations({{here, here}, {still, still}}, s)[0], 0, 0, 0);
}

TEST_CASE("cohesion pulls equally or with the square of the distance, where nobody pushes if asked", "[steering]") {
    steering::Settings s = quiet_settings();
    s.pull = 3;
    check_vector(accelerations({{here, {11.5F, 10, 10}}, {still, still}}, s)[0], 3, 0, 0);
    check_vector(accelerations({{here, {10.5F, 10, 10}}, {still, still}}, s)[1], -3, 0, 0);
    check_vector(accelerations({{here, {12.1F, 10, 10}}, {still, still}}, s)[0], 0, 0, 0);
    s.pull = 0;
    s.pull_growth = 3.0F / 4;
    check_vector(accelerations({{here, {11.5F, 10, 10}}, {still, still}}, s)[0], 3 * 1.5 * 1.5 / 4, 0, 0);
    s.no_pull_within = 1;
    check_vector(accelerations({{here, {10.5F, 10, 10}}, {still, still}}, s)[0], 0, 0, 0);
    check_vector(accelerations({{here, {11.5F, 10, 10}}, {still, still}}, s)[0], 3 * 1.5 * 1.5 / 4, 0, 0);
}

TEST_CASE("loss takes velocity relative to the neighbour, or the velocity itself", "[steering]") {
    steering::Settings s = quiet_settings();
    s.loss = 2;
    const Vehicles two{{here, {10.9F, 10, 10}}, {{1, 2, 3}, {0.5F, 0, 0}}};
    const double rate = 2 * (1 - 0.9 / 1.5);
    auto a = accelerations(two, s);
    check_vector(a[0], -rate * 0.5, -rate * 2, -rate * 3);
    check_vector(a[1], rate * 0.5, rate * 2, rate * 3);
    s.loss_relative = 0;
    a = accelerations(two, s);
    check_vector(a[0], -rate * 1, -rate * 2, -rate * 3);
    check_vector(a[1], -rate * 0.5, 0, 0);
    check_vector(accelerations({{here, {11.6F, 10, 10}}, {{1, 2, 3}, still}}, s)[0], 0, 0, 0);
}

TEST_CASE("alignment steers to the mean velocity of the neighbours", "[steering]") {
    steering::Settings s = quiet_settings();
    s.alignment = 4;
    s.plain = false;
    const auto a = accelerations(
        {{here, {11, 10, 10}, {10, 11.5F, 10}, {15, 15, 15}}, {still, {1, 0, 0}, {0, 2, 0}, {1, 1, 1}}}, s);
    check_vector(a[0], 4 * 0.5, 4 * 1.0, 0);
    check_vector(a[3], 0, 0, 0);  // sees no particle
}

TEST_CASE("a neighbourhood's angle counts from the velocity; a particle at rest sees all round", "[steering]") {
    steering::Settings s = quiet_settings();
    s.separation = 2;
    s.pull = 3;
    s.no_pull_within = 1;
    s.plain = false;
    s.separation_cos = 0;  // 90 degrees
    s.cohesion_cos = std::cos(0.5F);
    const double push = 2 * (1 / 0.25 - 1);
    const Vec3 ahead{10.5F, 10, 10};
    check_vector(accelerations({{here, ahead}, {{1, 0, 0}, still}}, s)[0], -push, 0, 0);
    check_vector(accelerations({{here, ahead}, {{-1, 0, 0}, still}}, s)[0], 0, 0, 0);
    check_vector(accelerations({{here, ahead}, {{-1, 0, 0}, still}}, s)[1], push, 0, 0);
    const Vec3 far_ahead{11.5F, 10, 10};
    check_vector(accelerations({{here, far_ahead}, {{2, 1, 0}, still}}, s)[0], 3, 0, 0);  // 0.46 rad
    check_vector(accelerations({{here, far_ahead}, {{2, 1.5F, 0}, still}}, s)[0], 0, 0, 0);
}

TEST_CASE("classes: a pair's radius is the mean of both, accelerations go with the inverse mass", "[steering]") {
    steering::Settings s = quiet_settings();
    s.separation = 2;
    s.plain = false;
    const Vehicles two{{here, {11.2F, 10, 10}}, {still, still}, {1.8F, 1}, {4, 0.5F}};
    const double force = 2 * (std::pow(1.4 / 1.2, 2) - 1);
    const auto a = accelerations(two, s);
    check_vector(a[0], -force / 4, 0, 0);
    check_vector(a[1], force / 0.5, 0, 0);
}

TEST_CASE("pair forces keep the momentum of a crowd of particles", "[steering]") {
    steering::Settings s = quiet_settings();
    s.separation = 2, s.pull = 0.3F, s.loss = 0.7F;
    Vehicles many;
    for (int k = 0; k < 60; ++k) {
        const auto u = [&](int m) { return static_cast<float>((k * m) % 61) / 61; };
        many.place.push_back({9 + 3 * u(17), 9 + 3 * u(23), 9 + 3 * u(40)});
        many.velocity.push_back({u(3) - 0.5F, u(5) - 0.5F, u(7) - 0.5F});
    }
    std::array<double, 3> sum{};
    double size = 0;
    for (const Vec3& a : accelerations(many, s)) {
        for (std::size_t k = 0; k < 3; ++k)
            sum[k] += static_cast<double>(a[k]), size += std::abs(static_cast<double>(a[k]));
    }
    REQUIRE(size > 100);
    for (const double component : sum) CHECK(std::abs(component) < 1e-4 * size);
}
