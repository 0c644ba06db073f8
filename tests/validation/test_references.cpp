// The solutions and measurements that cases are held against.

#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>

#include "configs/errors/exit_code.hpp"
#include "shallow_water_exact.hpp"
#include "spheric2_reference.hpp"
#include "viscous_exact.hpp"

using namespace wade;
using namespace wade::validation;

// Serre's equations against their solitary wave and against the shallow water that long waves are.
namespace serre_waves_test {

namespace {

// The wave of permanent form (Serre 1953): h = h_0 + a sech^2(k (x - c t)), k = sqrt(3 a / (4 h_0^2 (h_0 + a))),
// c = sqrt(g (h_0 + a)), u = c (1 - h_0 / h).
struct Solitary {
    double still = 1, height = 0.4, g = 9.81;
    [[nodiscard]] double speed() const { return std::sqrt(g * (still + height)); }
    [[nodiscard]] double depth(double x) const {
        const double k = std::sqrt(3 * height / (4 * still * still * (still + height)));
        return still + height / std::pow(std::cosh(k * x), 2);
    }
    [[nodiscard]] double velocity(double x) const { return speed() * (1 - still / depth(x)); }
};

// Worst distance from the wave's depths after it has run 20 m.
double error_after_20_m(double dx) {
    const Solitary wave;
    const double start = 15, duration = 20 / wave.speed();
    SerreWaves waves = serre_waves(
        50, dx, wave.g, [&](double x) { return wave.depth(x - start); },
        [&](double x) { return wave.velocity(x - start); });
    advance(waves, duration);
    double worst = 0;
    for (std::size_t i = 0; i < waves.depth.size(); ++i) {
        const double x = (static_cast<double>(i) + 0.5) * waves.dx;
        worst = std::max(worst, std::abs(waves.depth[i] - wave.depth(x - start - 20)));
    }
    return worst;
}

}  // namespace

TEST_CASE("Serre: the solitary wave keeps its form and its speed, to second order", "[exact]") {
    const double coarse = error_after_20_m(0.1), fine = error_after_20_m(0.05);
    CHECK(fine < 0.002);
    CHECK(coarse / fine > 3.5);
}

TEST_CASE("Serre: what a dam releases is as deep and as fast as shallow water far from its waves", "[exact]") {
    // Before the bore the waves are shorter than the water is deep, so that a mean over some of them counts.
    const double g = 9.81;
    const WetDamBreak dam = solve_wet_dam_break(1, 0.8, g);
    SerreWaves waves = serre_waves(
        80, 0.05, g, [](double x) { return 0.9 - 0.1 * std::tanh((x - 40) / 0.2); }, [](double) { return 0.0; });
    const double before = std::accumulate(waves.depth.begin(), waves.depth.end(), 0.0);
    advance(waves, 10);
    CHECK(std::accumulate(waves.depth.begin(), waves.depth.end(), 0.0) == Approx(before).epsilon(1e-9));
    // Between the rarefaction wave and the bore, 10 m long.
    double depth = 0, velocity = 0;
    const std::vector<double> u = velocities(waves);
    for (std::size_t i = 800; i < 1000; ++i) {
        depth += waves.depth[i] / 200;
        velocity += u[i] / 200;
    }
    CHECK(depth == Approx(dam.h_middle).epsilon(0.01));
    CHECK(velocity == Approx(dam.u_middle).epsilon(0.02));
    // The first crest is higher than the middle, by less than twice the rise from the still water.
    const double crest = *std::max_element(waves.depth.begin() + 1000, waves.depth.end());
    CHECK(crest > dam.h_middle + 0.02);
    CHECK(crest < dam.h_middle + (dam.h_middle - dam.h_right));
}

}  // namespace serre_waves_test

// The exact dam breaks against states published in textbooks and against their own conservation laws.
namespace shallow_water_exact_test {

TEST_CASE("Ritter: critical state at the dam, front at 2 c", "[exact]") {
    const double g = 9.81;
    const FlowState dam = ritter(0, 1, 1, g);
    CHECK(dam.depth == Approx(4.0 / 9));
    CHECK(dam.velocity == Approx(2.0 / 3 * std::sqrt(g)));
    CHECK(ritter(2.001 * std::sqrt(g), 1, 1, g).depth == 0);
    CHECK(ritter(-1.001 * std::sqrt(g), 1, 1, g).depth == 1);
    CHECK(ritter(0.9, 0.5, 1, g).depth == Approx(0.22575).epsilon(1e-3));
}

TEST_CASE("Stoker: states between wave and shock", "[exact]") {
    // depth and velocity of the middle state and speed of the shock for h_l = 1 m, g = 9.81 m/s2
    const double table[][4] = {{0.05, 0.310085, 2.77595, 3.30962},
                               {0.1, 0.396175, 2.32135, 3.10513},
                               {0.2, 0.507871, 1.80001, 2.96933},
                               {0.5, 0.72692, 0.923364, 2.95792}};
    for (const auto& row : table) {
        const WetDamBreak dam = solve_wet_dam_break(1, row[0], 9.81);
        CHECK(dam.h_middle == Approx(row[1]).epsilon(1e-5));
        CHECK(dam.u_middle == Approx(row[2]).epsilon(1e-5));
        CHECK(dam.shock_speed == Approx(row[3]).epsilon(1e-5));
    }
}

TEST_CASE("Stoker: the water is neither more nor less than before the break", "[exact]") {
    const WetDamBreak dam = solve_wet_dam_break(1, 0.2, 9.81);
    double volume = 0;
    const double ds = 0.001;
    for (double s = -8 + ds / 2; s < 8; s += ds) {
        volume += stoker(dam, s, 2).depth * ds;
    }
    CHECK(volume == Approx(8 * 1 + 8 * 0.2).epsilon(1e-4));
}

}  // namespace shallow_water_exact_test

// The table of SPHERIC test 2 and the reader of the whole series.
namespace spheric2_reference_test {

namespace {

// A made-up series: a front passes H1 at 1 s and the pressure at P1 peaks at 2 s.
std::filesystem::path write_series(const std::string& header, int rows) {
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("wade-spheric2-" + std::to_string(::getpid()) + ".csv");
    std::ofstream out(file);
    out << header << '\n';
    for (int k = 0; k < rows; ++k) {
        const double t = 0.02 * k;
        out << t << ",0,0," << (t > 0.99 ? 0.06 : 0) << ",0.55," << (k == 100 ? 5000 : 100) << ",50\n";
    }
    return file;
}

}  // namespace

TEST_CASE("the table covers three seconds", "[spheric2]") {
    const Spheric2Reference table = spheric2_table();
    CHECK_FALSE(table.series);
    CHECK(table.time.back() == 3);
    for (const auto& height : table.height) {
        CHECK(height.size() == table.time.size());
    }
    for (const auto& pressure : table.pressure) {
        CHECK(pressure.size() == table.time.size());
    }
    CHECK(table.height[3][0] == 0.55);
}

TEST_CASE("an arrival lies between two samples", "[spheric2]") {
    CHECK(arrival_time({0, 1, 2}, {0, 0.01, 0.05}) == Approx(1.5));
    CHECK(arrival_time({0, 1}, {0.1, 0.1}) == 0);
    CHECK(std::isnan(arrival_time({0, 1}, {0, 0.02})));
}

TEST_CASE("a series is read by the names of its columns", "[spheric2]") {
    const std::filesystem::path file = write_series("t_s,H3_m,H2_m,H1_m,H4_m,P1_Pa,P3_Pa", 201);
    const Spheric2Reference series = spheric2_series(file);
    CHECK(series.series);
    CHECK(series.time.size() == 151);
    CHECK(series.arrival[0] == Approx(0.99).margin(0.011));
    CHECK(std::isnan(series.arrival[1]));
    CHECK(series.peak[0] == 5000);
    CHECK(series.peak_time[0] == Approx(2));
    CHECK(series.peak[1] == 50);
    std::filesystem::remove(file);
}

TEST_CASE("a series that is not one is refused", "[spheric2]") {
    CHECK_THROWS_AS(spheric2_series("no/such/file.csv"), ConfigurationError);
    const std::filesystem::path unnamed = write_series("t_s,H3_m,H2_m,H1_m,H4_m,P1_Pa,P2_Pa", 201);
    CHECK_THROWS_AS(spheric2_series(unnamed), ConfigurationError);
    const std::filesystem::path shorter = write_series("t_s,H3_m,H2_m,H1_m,H4_m,P1_Pa,P3_Pa", 100);
    CHECK_THROWS_AS(spheric2_series(shorter), ConfigurationError);
    std::filesystem::remove(shorter);
}

}  // namespace spheric2_reference_test

// The exact solutions satisfy their equations, their boundaries and their start.
namespace viscous_exact_test {

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

}  // namespace viscous_exact_test
