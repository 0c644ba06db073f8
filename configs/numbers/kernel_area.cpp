#include "configs/numbers/kernel_area.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wade {
namespace {

// G of the header: the quarter of the cone up to x = a.
double cone_up_to(double a) {
    const double s = std::sqrt(std::max(0.0, 1 - a * a));
    const double curved = a > 0 ? a * a * a * std::log((1 + s) / a) : 0;
    return (2 * a * s + std::asin(a) - curved) / 6;
}

// D of the header.
double disc_up_to(double a) {
    return 0.5 * (a * std::sqrt(std::max(0.0, 1 - a * a)) + std::asin(a));
}

double cone_corner(double a, double b) {
    if (!(a > 0 && b > 0)) return 0;
    const double square = a * a + b * b;
    if (square >= 1) return cone_up_to(a) + cone_up_to(b) - std::numbers::pi / 12;
    return a * b - (2 * a * b * std::sqrt(square) + a * a * a * std::asinh(b / a) + b * b * b * std::asinh(a / b)) / 6;
}

double disc_corner(double a, double b) {
    return a * a + b * b >= 1 ? disc_up_to(a) + disc_up_to(b) - std::numbers::pi / 4 : a * b;
}

// The sum over the corners of a rectangle, each with its signs; `corner` takes lengths of 0 to 1.
template <typename Corner>
double over(const Rectangle& r, Corner corner) {
    const auto signed_corner = [&](double x, double z) {
        const double part = corner(std::min(std::abs(x), 1.0), std::min(std::abs(z), 1.0));
        return (x < 0) == (z < 0) ? part : -part;
    };
    return (signed_corner(r.x_hi, r.z_hi) - signed_corner(r.x_lo, r.z_hi)) -
           (signed_corner(r.x_hi, r.z_lo) - signed_corner(r.x_lo, r.z_lo));
}

// Returns false where the rectangle lies beyond the circle; the sum over its corners would leave rounding.
bool meets_circle(const Rectangle& r) {
    const double x = std::max({r.x_lo, -r.x_hi, 0.0}), z = std::max({r.z_lo, -r.z_hi, 0.0});
    return x * x + z * z < 1;
}

}  // namespace

double cone_over(const Rectangle& rectangle) {
    return meets_circle(rectangle) ? std::max(0.0, over(rectangle, cone_corner)) : 0;
}

double disc_over(const Rectangle& rectangle) {
    return meets_circle(rectangle) ? std::max(0.0, over(rectangle, disc_corner)) : 0;
}

}  // namespace wade
