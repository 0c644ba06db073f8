// Velocities at points, from scattered particles.

#include <catch2/catch.hpp>
#include <cmath>

#include "ghia_cavity.hpp"
#include "viscous_measures.hpp"

using namespace wade;
using namespace wade::validation;

namespace {

// Particles on a sheared lattice over the unit square, with the velocity (1 + 2 x - 3 y, x y, 0).
fluid::Particles particles_in_square(int n) {
    fluid::Particles p(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            const double y = (j + 0.5) / n;
            const double x = std::fmod((i + 0.5) / n + 0.3 * y, 1.0);
            const auto at = [](double v) { return static_cast<float>(v); };
            p.add({at(x), at(y), 0}, {at(1 + 2 * x - 3 * y), at(x * y), 0}, fluid::Kind::fluid);
        }
    }
    return p;
}

}  // namespace

TEST_CASE("a linear field is met exactly, at walls and corners as well", "[viscous_measures]") {
    const fluid::Particles p = particles_in_square(20);
    PointSamples samples({{0.5, 0.5}, {0.5, 1.0}, {0.0, 0.0}, {0.98, 0.5}}, 0, 0.15);
    samples.add(p);
    samples.add(p);  // the mean of two frames that are equal
    CHECK(samples.velocity(0) == Approx(0.5).margin(1e-5));
    CHECK(samples.velocity(1) == Approx(-1.0).margin(1e-5));
    CHECK(samples.velocity(2) == Approx(1.0).margin(1e-5));
    CHECK(samples.velocity(3) == Approx(1.46).margin(1e-5));
}

TEST_CASE("the other component, and a point without particles", "[viscous_measures]") {
    PointSamples samples({{0.5, 0.5}, {3.0, 3.0}}, 1, 0.15);
    samples.add(particles_in_square(20));
    CHECK(samples.velocity(0) == Approx(0.25).margin(1e-3));
    CHECK(std::isnan(samples.velocity(1)));
}

TEST_CASE("the table of the cavity conserves mass", "[viscous_measures]") {
    // What flows one way through a centre line flows back through it: trapezoidal rule, as exact as the points are dense.
    const auto flux = [](const auto& table, std::size_t column, bool gaps) {
        double sum = 0;
        for (std::size_t i = 1; i < table.size(); ++i) {
            std::size_t last = i - 1;
            if (gaps && std::isnan(table[i].velocity[column])) continue;
            if (gaps && std::isnan(table[last].velocity[column])) --last;
            sum +=
                (table[last].place - table[i].place) * (table[last].velocity[column] + table[i].velocity[column]) / 2;
        }
        return sum;
    };
    for (std::size_t column = 0; column < ghia_reynolds_numbers.size(); ++column) {
        CHECK(std::abs(flux(ghia_u, column, false)) < 0.02);
        CHECK(std::abs(flux(ghia_v, column, true)) < 0.02);
    }
}
