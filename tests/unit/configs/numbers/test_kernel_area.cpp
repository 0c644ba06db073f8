#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "configs/numbers/kernel_area.hpp"

using namespace wade;

namespace {

// The integral by n x n squares of the rectangle, each with its middle.
template <typename Kernel>
double counted(const Rectangle& r, int n, Kernel kernel) {
    const double dx = (r.x_hi - r.x_lo) / n, dz = (r.z_hi - r.z_lo) / n;
    double sum = 0;
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) sum += kernel(std::hypot(r.x_lo + (i + 0.5) * dx, r.z_lo + (j + 0.5) * dz));
    }
    return sum * dx * dz;
}

}  // namespace

TEST_CASE("The integrals of cone and disc over a rectangle are those of many small squares") {
    // Inside, cut by the circle once, twice and at corners, round the centre, beyond the circle.
    const Rectangle r =
        GENERATE(Rectangle{0.1, 0.3, 0.2, 0.5}, Rectangle{-0.3, 0.3, -0.2, 0.4}, Rectangle{0.5, 1.5, -0.2, 0.4},
                 Rectangle{0.5, 1.5, 0.4, 2}, Rectangle{-3, 3, -3, 3}, Rectangle{-3, 0.2, -0.1, 5},
                 Rectangle{-0.8, 0.8, -0.9, 0.9}, Rectangle{0.71, 1, 0.71, 1}, Rectangle{1.1, 2, -1, 1},
                 Rectangle{-1, 0, 0, 1}, Rectangle{-1.2, -0.9, -0.1, 0.1});
    CAPTURE(r.x_lo, r.x_hi, r.z_lo, r.z_hi);
    CHECK(cone_over(r) == Approx(counted(r, 2000, [](double d) { return std::max(0.0, 1 - d); })).margin(2e-5));
    // A square at the circle counts whole or not at all: 2,000 x 2,000 of them leave some 1e-3 of an area of 36.
    CHECK(disc_over(r) == Approx(counted(r, 2000, [](double d) { return d < 1 ? 1.0 : 0.0; })).margin(3e-3));
}

TEST_CASE("Rectangles that tile the plane share the whole kernel") {
    const double size = GENERATE(0.2, 0.5, 1.0, 4.0), x0 = GENERATE(0.0, 0.07, 0.6);
    double cone = 0, disc = 0;
    for (double x = -9 + x0; x < 9; x += size) {
        for (double z = -9 + 0.3 * x0; z < 9; z += size) {
            cone += cone_over({x, x + size, z, z + size});
            disc += disc_over({x, x + size, z, z + size});
        }
    }
    CHECK(cone == Approx(std::numbers::pi / 3).epsilon(1e-12));
    CHECK(disc == Approx(std::numbers::pi).epsilon(1e-12));
}
