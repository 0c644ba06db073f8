#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "configs/scene/steering_behaviours.hpp"

using namespace wade::behaviours;

namespace {

Vehicle vehicle_at(const Vector& place, const Vector& velocity) {
    Vehicle v;
    v.position = place;
    v.velocity = velocity;
    v.max_speed = 2;
    v.max_force = 3;
    v.mass = 1.5;
    align_frame(v);
    return v;
}

void check_equal(const Vector& a, const Vector& b) {
    for (std::size_t k = 0; k < 3; ++k) CHECK(a[k] == Approx(b[k]).margin(1e-12));
}

}  // namespace

TEST_CASE("seek and flee steer from the velocity to full speed towards and away from a place", "[steering]") {
    const Vehicle v = vehicle_at({1, 0, 0}, {0, 0, 1});
    check_equal(seek(v, {4, 4, 0}), {2 * 0.6, 2 * 0.8, -1});
    check_equal(flee(v, {4, 4, 0}), {-2 * 0.6, -2 * 0.8, -1});
    check_equal(seek(v, {1, 0, 0}), {0, 0, -1});  // on the target there is no direction
}

TEST_CASE("pursuit and evasion aim at where the other will be, not further ahead than the longest time", "[steering]") {
    const Vehicle v = vehicle_at({0, 0, 0}, {});
    const Vector place{6, 0, 0}, velocity{0, 0, 1};
    // T = D / max_speed = 3 s.
    check_equal(predicted(v, place, velocity, 10), {6, 0, 3});
    check_equal(predicted(v, place, velocity, 2), {6, 0, 2});
    check_equal(pursuit(v, place, velocity, 10), seek(v, {6, 0, 3}));
    check_equal(evasion(v, place, velocity, 2), flee(v, {6, 0, 2}));
}

TEST_CASE("arrival slows down within the slowing distance and wants to stand on the target", "[steering]") {
    const Vehicle v = vehicle_at({0, 0, 0}, {0.5, 0, 0});
    check_equal(arrival(v, {10, 0, 0}, 4), {2 - 0.5, 0, 0});
    check_equal(arrival(v, {1, 0, 0}, 4), {2 * 0.25 - 0.5, 0, 0});
    check_equal(arrival(v, {0, 0, 0}, 4), {-0.5, 0, 0});
}

TEST_CASE("a vehicle that arrives comes to rest on its target", "[steering]") {
    Vehicle v = vehicle_at({0, 0, 0}, {0, 1, 0});
    v.max_force = 20;
    for (int k = 0; k < 2000; ++k) steer(v, times(v.mass * 5, arrival(v, {5, 0, 1}, 2)), 0.01);
    CHECK(length(minus(v.position, {5, 0, 1})) < 1e-3);
    CHECK(length(v.velocity) < 1e-3);
}

TEST_CASE("force and speed of a vehicle keep their limits", "[steering]") {
    Vehicle v = vehicle_at({0, 0, 0}, {});
    steer(v, {30, 0, 40}, 0.1);
    // Truncated to 3 N along (0.6, 0, 0.8), a = 2 m/s^2.
    check_equal(v.velocity, {0.12, 0, 0.16});
    check_equal(v.position, {0.012, 0, 0.016});
    for (int k = 0; k < 100; ++k) steer(v, {30, 0, 40}, 0.1);
    CHECK(length(v.velocity) == Approx(2));
}

TEST_CASE("the local frame follows the velocity and stays orthonormal", "[steering]") {
    Vehicle v = vehicle_at({0, 0, 0}, {1, 0, 0});
    check_equal(v.forward, {1, 0, 0});
    check_equal(v.up, {0, 1, 0});
    check_equal(v.side, {0, 0, 1});
    // Also straight up, where the old up is no help.
    for (const Vector& velocity : {Vector{0, 0, 1}, Vector{-1, 2, 0.5}, Vector{0, 3, 0}, Vector{0, -3, 0}}) {
        v.velocity = velocity;
        align_frame(v);
        check_equal(v.forward, direction(velocity));
        check_equal(cross(v.forward, v.up), v.side);
        CHECK(dot(v.forward, v.up) == Approx(0).margin(1e-12));
        CHECK(length(v.up) == Approx(1));
    }
    const Vector before = v.forward;
    v.velocity = {};
    align_frame(v);
    check_equal(v.forward, before);
}

TEST_CASE("the neighbourhood is bounded by distance and angle", "[steering]") {
    const Vehicle v = vehicle_at({0, 0, 0}, {1, 0, 0});
    const double right = std::numbers::pi / 2;
    CHECK(in_neighbourhood(v, {0.9, 0, 0}, 1, right));
    CHECK_FALSE(in_neighbourhood(v, {1.1, 0, 0}, 1, right));
    CHECK(in_neighbourhood(v, {0.1, 0.9, 0}, 1, right));
    CHECK_FALSE(in_neighbourhood(v, {-0.1, 0.9, 0}, 1, right));
    CHECK(in_neighbourhood(v, {-0.5, 0, 0}, 1, std::numbers::pi));
}
