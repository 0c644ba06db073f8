#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "fluid_server/kernel.hpp"

using wade::fluid::CubicSpline;

TEST_CASE("the kernel integrates to one over its support", "[fluid][kernel]") {
    const float h = 0.7F;
    const CubicSpline kernel(h);
    const int n = 20000;
    double integral = 0;
    for (int i = 0; i < n; ++i) {
        const double r = (i + 0.5) * 0.7 / n;
        integral += static_cast<double>(kernel.value(static_cast<float>(r))) * 4 * std::numbers::pi * r * r * 0.7 / n;
    }
    CHECK(integral == Approx(1).margin(1e-5));  // single precision of the kernel
}

TEST_CASE("the kernel and its gradient vanish at the support radius and beyond", "[fluid][kernel]") {
    const CubicSpline kernel(0.5F);
    CHECK(kernel.value(0.5F) == 0);
    CHECK(kernel.value(0.6F) == 0);
    CHECK(kernel.gradient_factor(0.5F) == 0);
    CHECK(kernel.gradient_factor(0.6F) == 0);
    CHECK(std::isfinite(kernel.gradient_factor(0)));
}

TEST_CASE("the gradient factor is dW/dr / r", "[fluid][kernel]") {
    const CubicSpline kernel(1);
    for (const float r : {0.1F, 0.3F, 0.49F, 0.51F, 0.7F, 0.95F}) {
        const float e = 1e-3F;
        const float slope = (kernel.value(r + e) - kernel.value(r - e)) / (2 * e);
        // Central difference: error e^2 W''' / 6 < 1e-4, and rounding of W / e of about 1e-4.
        CHECK(r * kernel.gradient_factor(r) == Approx(slope).margin(1e-3));
    }
}

TEST_CASE("a cubic lattice has rest density with a support radius of two spacings", "[fluid][kernel]") {
    const CubicSpline kernel(2);
    double sum = 0;
    for (int i = -2; i <= 2; ++i) {
        for (int j = -2; j <= 2; ++j) {
            for (int k = -2; k <= 2; ++k) {
                sum += static_cast<double>(kernel.value(std::sqrt(static_cast<float>(i * i + j * j + k * k))));
            }
        }
    }
    CHECK(sum == Approx(1).margin(5e-4));  // 1.0000 by hand: 0.3183 + 6 * 0.0796 + 12 * 0.0160 + 8 * 0.0015
}
