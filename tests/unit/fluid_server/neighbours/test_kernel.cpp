#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "fluid_server/neighbours/kernel.hpp"

using wade::fluid::CubicSpline;
using wade::fluid::QuarticSpline;
using wade::fluid::WendlandC2;

namespace {

// A kernel of the support radius h, as scenes have it.
template <typename Kernel>
Kernel kernel_of(float h) {
    if constexpr (std::is_same_v<Kernel, QuarticSpline>) {
        return QuarticSpline(h, 2.4);
    } else {
        return Kernel(h);
    }
}

}  // namespace

TEMPLATE_TEST_CASE("the kernel integrates to one over its support", "[fluid][kernel]", CubicSpline, QuarticSpline,
                   WendlandC2) {
    const float h = 0.7F;
    const auto kernel = kernel_of<TestType>(h);
    const int n = 20000;
    double integral = 0;
    for (int i = 0; i < n; ++i) {
        const double r = (i + 0.5) * 0.7 / n;
        integral += static_cast<double>(kernel.value(static_cast<float>(r))) * 4 * std::numbers::pi * r * r * 0.7 / n;
    }
    // Single precision of the kernel; those that are divided by their sum over the lattice, 1.0003 and 1.0032, integrate to
    // its inverse.
    const double sum = std::is_same_v<TestType, CubicSpline>     ? 1
                       : std::is_same_v<TestType, QuarticSpline> ? 1.000322
                                                                 : 1.003141;
    CHECK(integral == Approx(1 / sum).margin(1e-5));
}

TEMPLATE_TEST_CASE("the kernel and its gradient vanish at the support radius and beyond", "[fluid][kernel]",
                   CubicSpline, QuarticSpline, WendlandC2) {
    const auto kernel = kernel_of<TestType>(0.5F);
    CHECK(kernel.value(0.5F) == 0);
    CHECK(kernel.value(0.6F) == 0);
    CHECK(kernel.gradient_factor(0.5F) == 0);
    CHECK(kernel.gradient_factor(0.6F) == 0);
    CHECK(std::isfinite(kernel.gradient_factor(0)));
}

TEMPLATE_TEST_CASE("the gradient factor is dW/dr / r", "[fluid][kernel]", CubicSpline, QuarticSpline, WendlandC2) {
    const auto kernel = kernel_of<TestType>(1);
    // On both sides of the knots of the splines.
    for (const float r : {0.1F, 0.19F, 0.21F, 0.3F, 0.49F, 0.51F, 0.59F, 0.61F, 0.7F, 0.95F}) {
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

namespace {

// d^3 sum W of the lattice after x' = xx x + xy y, y' = xy x + yy y.
template <typename Kernel = CubicSpline>
double strained_density(double support, double xx, double xy, double yy) {
    const Kernel kernel(static_cast<float>(support), support);
    double sum = 0;
    for (int i = -3; i <= 3; ++i) {
        for (int j = -3; j <= 3; ++j) {
            for (int k = -3; k <= 3; ++k) {
                const double x = xx * i + xy * j, y = xy * i + yy * j;
                sum += static_cast<double>(kernel.value(static_cast<float>(std::sqrt(x * x + y * y + k * k))));
            }
        }
    }
    return sum;
}

// Why a standing wave is too fast at any spacing (docs/limits.md). Stretched along an axis by the strain e, or along a
// diagonal, at constant volume, the lattice has the density 1 + s e^2. To be at rest density it swells by s e^2 against the
// pressure rho g (h - y) and so lifts the water above. Over potential flow in water h deep, k = pi / L,
//
//   e_xx = -e_yy = a k cos(kx) cosh(ky) / sinh(kh),   e_xy = -a k sin(kx) sinh(ky) / sinh(kh),
//
// that energy is S times the wave's own, rho g a^2 / 4 per unit of area, with S the mean of both s over
// (h - y) cosh^2(ky) and (h - y) sinh^2(ky): omega grows by S / 2.
template <typename Kernel = CubicSpline>
double faster_by(double support, double e) {
    const auto density = [support](double xx, double xy, double yy) {
        return strained_density<Kernel>(support, xx, xy, yy);
    };
    const double at_rest = density(1, 0, 1);
    const double along = (density(std::exp(e), 0, std::exp(-e)) / at_rest - 1) / (e * e);
    const double diagonal = (density(std::cosh(e), std::sinh(e), std::cosh(e)) / at_rest - 1) / (e * e);
    const double kh = std::numbers::pi / 2;  // of the validation case `sloshing`
    const double both = (std::cosh(2 * kh) - 1) / 4, difference = kh * kh / 2;
    const double of_along = (both + difference) / 2, of_diagonal = (both - difference) / 2;
    return (along * of_along + diagonal * of_diagonal) / (of_along + of_diagonal) / 2;
}

}  // namespace

TEST_CASE("a lattice resists shear as a solid, unless its support radius is 2.05 spacings", "[fluid][kernel]") {
    // Single precision of the sums over e^2.
    CHECK(faster_by(2, 0.02) == Approx(0.036).margin(1e-3));
    CHECK(faster_by(2, 0.05) == Approx(0.043).margin(1e-3));
    CHECK(std::abs(faster_by(2.05, 0.02)) < 1e-3);
    CHECK(std::abs(faster_by(2.05, 0.05)) < 3e-3);
    CHECK(faster_by(2.1, 0.05) < -0.03);  // no state of rest: such a lattice flows
}

TEST_CASE("with the quartic spline a lattice has no shape that it would keep", "[fluid][kernel]") {
    // A fifth of what the cubic spline has, up to strains beyond those of the wave.
    for (const double e : {0.02, 0.05, 0.1}) {
        CHECK(std::abs(faster_by<QuarticSpline>(2.4, e)) < faster_by(2, e) / 5);
    }
    CHECK(strained_density<QuarticSpline>(2.4, 1, 0, 1) == Approx(1).margin(1e-5));  // single precision
}

TEST_CASE("the lattice has rest density with a wider support too", "[fluid][kernel]") {
    for (const double support : {2.01, 2.05, 2.1, 2.2}) {
        CHECK(strained_density(support, 1, 0, 1) == Approx(1).margin(1e-5));  // single precision
    }
}
