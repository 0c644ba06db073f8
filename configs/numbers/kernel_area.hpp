#pragma once
// Integrals of the two sampling kernels of the crowd over rectangles, in units of the kernel's radius.
//
// With r^2 = a^2 + b^2 and s = sqrt(1 - a^2), the part of a kernel over [0, a] x [0, b], 0 <= a, b <= 1, is
//
//   cone 1 - r, r <= 1   a b - (2 a b r + a^3 asinh(b / a) + b^3 asinh(a / b)) / 6
//        r > 1           G(a) + G(b) - pi / 12,  G(a) = a s / 3 + asin(a) / 6 - a^3 acosh(1 / a) / 6
//   disc 1, r <= 1       a b
//        r > 1           D(a) + D(b) - pi / 4,   D(a) = (a s + asin(a)) / 2
//
// The second line of each follows from the quarter of the kernel: the parts beyond x = a and beyond z = b do not overlap.

namespace wade {

// A rectangle with its sides along the axes; the kernel is centred on the origin and has the radius 1.
struct Rectangle {
    double x_lo = 0, x_hi = 0, z_lo = 0, z_hi = 0;
};

// Returns the integral of max(0, 1 - r) over the rectangle, 0 to pi / 3.
[[nodiscard]] double cone_over(const Rectangle& rectangle);

// Returns the area of the rectangle within the disc, 0 to pi.
[[nodiscard]] double disc_over(const Rectangle& rectangle);

}  // namespace wade
