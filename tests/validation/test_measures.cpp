// What is measured of waters that are known.

#include <catch2/catch.hpp>
#include <cmath>

#include "damped_cosine.hpp"
#include "probes.hpp"
#include "profiles.hpp"
#include "viscous_exact.hpp"
#include "viscous_measures.hpp"

using namespace wade;
using namespace wade::validation;

namespace damped_cosine_test {

TEST_CASE("a damped cosine is found again", "[exact]") {
    std::vector<double> times, values;
    for (int i = 0; i < 400; ++i) {
        const double t = 0.025 * i;
        times.push_back(t);
        values.push_back(0.01 * std::exp(-0.07 * t) * std::cos(5.6 * t + 0.4) + 0.5 + 1e-4 * std::sin(31 * t));
    }
    const DampedCosine fit = fit_damped_cosine(times, values, 5.3);
    CHECK(fit.omega == Approx(5.6).epsilon(1e-3));
    CHECK(fit.damping == Approx(0.07).epsilon(2e-2));
    CHECK(fit.offset == Approx(0.5).epsilon(1e-3));
    CHECK(std::hypot(fit.a, fit.b) == Approx(0.01).epsilon(1e-2));
    CHECK(fit.residual < 0.02);
}

}  // namespace damped_cosine_test

// What the instruments read in still water, where it is known.
namespace probes_test {

namespace {

constexpr double d = 0.1;     // m, spacing
constexpr int layers = 8;     // of the water, in a tank of 1 m x 1 m with a wall at x = 0
constexpr double rho = 1000;  // kg/m^3

// A lattice at rest with hydrostatic pressure.
fluid::Particles still_water() {
    fluid::Particles p(1000);
    for (int i = 0; i < 10 * layers * 10; ++i) {
        const auto along = [](int k) { return static_cast<float>((k + 0.5) * d); };
        p.add({along(i % 10), along(i / 10 % layers), along(i / 10 / layers)}, {0, 0, 0}, fluid::Kind::fluid);
        const float pressure = 9.81F * (static_cast<float>(layers * d) - p.y[p.count - 1]);
        p.pressure[p.count - 1] = pressure;
    }
    return p;
}

}  // namespace

TEST_CASE("a wire in still water is wet up to the surface, wherever it stands", "[probes]") {
    const fluid::Particles p = still_water();
    for (const double x : {0.5, 0.517, 0.55}) {
        for (const double z : {0.4, 0.45, 0.49}) {
            CHECK(wet_length(p, x, z, d) == Approx(layers * d).epsilon(1e-4));
        }
    }
    CHECK(wet_length(p, 3, 0.5, d) == 0);
}

TEST_CASE("a sensor in a wall reads the hydrostatic pressure, and nothing above the water", "[probes]") {
    const fluid::Particles p = still_water();
    for (const double y : {0.3, 0.41, 0.5}) {
        CHECK(wall_pressure(p, {0, y, 0.5}, d, rho) == Approx(rho * 9.81 * (layers * d - y)).epsilon(0.02));
    }
    CHECK(wall_pressure(p, {0, layers * d + 2 * d, 0.5}, d, rho) == 0);
    // The last layer alone touches the sensor: less than half of a wet wall.
    CHECK(wall_pressure(p, {0, layers * d + 0.5 * d, 0.5}, d, rho) < 0.5 * rho * 9.81 * 0.5 * d);
}

}  // namespace probes_test

namespace profiles_test {

TEST_CASE("columns hold all the water, whatever their length", "[profiles]") {
    fluid::Particles particles(40);
    const double d = 0.1;
    for (int i = 0; i < 10; ++i) {
        for (int j = 0; j < 4; ++j) {
            particles.add({static_cast<float>(d * (i + 0.5)), static_cast<float>(d * (j + 0.5)), 0.05F}, {-2, 0, 0},
                          fluid::Kind::fluid);
        }
    }
    for (const double column : {0.1, 0.125, 0.25, 0.35}) {
        Columns columns = make_columns({0, 1}, d, column);
        sample(particles, d, columns);
        sample(particles, d, columns);
        for (std::size_t k = 0; k < columns.count(); ++k) {
            CHECK(columns.depth(k) == Approx(0.4).epsilon(1e-5));
            CHECK(columns.velocity(k) == Approx(-2));
        }
    }
    CHECK(leading_x(particles, 1) == Approx(0.05));
}

TEST_CASE("water beyond the columns does not count", "[profiles]") {
    fluid::Particles particles(3);
    particles.add({-0.05F, 0, 0}, {1, 0, 0}, fluid::Kind::fluid);
    particles.add({0, 0, 0}, {1, 0, 0}, fluid::Kind::fluid);
    particles.add({0.5F, 0, 0}, {1, 0, 0}, fluid::Kind::inflow);
    Columns columns = make_columns({0, 1}, 0.1, 0.5);
    sample(particles, 0.1, columns);
    CHECK(columns.volume[0] == Approx(0.0005));
    CHECK(columns.volume[1] == 0);
    CHECK(columns.velocity(1) == 0);
}

TEST_CASE("of several starts each metric is the median, with the least and the largest", "[starts]") {
    const auto run = [](double error, double cpu) {
        Result result;
        result.metrics = {{"error", error, "1"}, {"same", 2, "m"}};
        result.solver_cpu_time = cpu, result.steps = 10;
        return result;
    };
    const Result three = medians_of({run(0.3, 1), run(0.1, 2), run(0.2, 4)});
    CHECK((three.metrics[0].value == 0.2 && three.metrics[0].low == 0.1 && three.metrics[0].high == 0.3));
    CHECK((three.metrics[1].value == 2 && three.metrics[1].unit == "m"));
    CHECK((three.solver_cpu_time == 7 && three.steps == 30));
    CHECK(std::abs(medians_of({run(0.4, 1), run(0.2, 1)}).metrics[0].value - 0.3) < 1e-15);
    CHECK(std::isnan(medians_of({run(0.3, 1), run(std::nan(""), 1)}).metrics[0].value));  // fails its threshold
}

TEST_CASE("quantiles", "[profiles]") {
    CHECK(quantile({3, 1, 2}, 0.5) == 2);
    CHECK(quantile({1, 2, 3, 4}, 0.5) == 2.5);
    CHECK(quantile({5}, 0.95) == 5);
    CHECK(std::isnan(quantile({}, 0.5)));
}

}  // namespace profiles_test

// Velocities at points, from scattered particles.
namespace viscous_measures_test {

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
    // The net flux through a centre line is zero, by the trapezoidal rule as exactly as the points are dense.
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

}  // namespace viscous_measures_test
