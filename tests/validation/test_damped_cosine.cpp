#include <catch2/catch.hpp>
#include <cmath>

#include "damped_cosine.hpp"

using namespace wade::validation;

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
