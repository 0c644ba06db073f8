// The exact solutions satisfy their equations, their boundaries and their start.

#include <catch2/catch.hpp>
#include <cmath>

#include "viscous_exact.hpp"

using namespace wade::validation;

namespace {

constexpr double height = 2;
constexpr double viscosity = 0.5;
constexpr double drive = 0.3;  // acceleration or speed of the plane

// du/dt - nu d2u/dy2 by central differences.
template <typename Flow>
double residual(Flow&& u, double y, double t) {
    const double dy = 1e-3;
    const double dt = 1e-5;
    return (u(y, t + dt) - u(y, t - dt)) / (2 * dt) -
           viscosity * (u(y + dy, t) - 2 * u(y, t) + u(y - dy, t)) / (dy * dy);
}

}  // namespace

TEST_CASE("start-up of Poiseuille flow", "[viscous_exact]") {
    const auto u = [](double y, double t) { return poiseuille_velocity(y, t, drive, viscosity, height); };
    for (const double t : {0.01, 0.1, 1.0}) {
        CHECK(u(0, t) == Approx(0).margin(1e-12));
        CHECK(u(height, t) == Approx(0).margin(1e-12));
        for (const double y : {0.3, 1.0, 1.9}) {
            CHECK(residual(u, y, t) == Approx(drive).epsilon(1e-4));
        }
    }
    CHECK(u(0.7, 0) == Approx(0).margin(1e-9));                             // at rest
    CHECK(u(1, 1e-3) == Approx(drive * 1e-3).epsilon(1e-6));                // far from the planes it falls freely
    CHECK(u(1, 100) == Approx(drive * height * height / (8 * viscosity)));  // steady peak
}

TEST_CASE("start-up of Couette flow", "[viscous_exact]") {
    const auto u = [](double y, double t) { return couette_velocity(y, t, drive, viscosity, height); };
    for (const double t : {0.01, 0.1, 1.0}) {
        CHECK(u(0, t) == Approx(0).margin(1e-12));
        CHECK(u(height, t) == Approx(drive));
        for (const double y : {0.3, 1.0, 1.9}) {
            // Each of its two terms is up to drive / t = 30; the differences are exact to 1e-5 of that.
            CHECK(residual(u, y, t) == Approx(0).margin(1e-3 * drive));
        }
    }
    CHECK(u(0.7, 100) == Approx(drive * 0.7 / height));
    // Near a plane that has just started the flow is that of Stokes' first problem: erfc(s / sqrt(4 nu t)).
    const double t = 0.01;
    CHECK(u(height - 0.1, t) == Approx(drive * std::erfc(0.1 / std::sqrt(4 * viscosity * t))).epsilon(1e-9));
}

TEST_CASE("values of Morris et al. (1997)", "[viscous_exact]") {
    // Channel of 1 mm, nu = 1e-6 m^2/s, peak or plane at 1.25e-5 m/s, t = 0.0225 s: independently computed.
    CHECK(poiseuille_velocity(5e-4, 0.0225, 1e-4, 1e-6, 1e-3) == Approx(2.23274e-6).epsilon(1e-5));
    CHECK(couette_velocity(9.5e-4, 0.0225, 1.25e-5, 1e-6, 1e-3) == Approx(1.01708e-5).epsilon(1e-5));
}

TEST_CASE("decay of the Taylor-Green vortex", "[viscous_exact]") {
    CHECK(taylor_green_decay(0, 0.01, 1) == 1);
    CHECK(taylor_green_decay(1, 0.01, 1) == Approx(0.454041).epsilon(1e-5));
}
