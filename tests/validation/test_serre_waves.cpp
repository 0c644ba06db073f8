// Serre's equations against their solitary wave and against the shallow water that long waves are.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "serre_waves.hpp"
#include "shallow_water_exact.hpp"

using namespace wade::validation;

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
