#pragma once
// Functions with the same bits on all processors with IEEE arithmetic. In glibc 2.36 cbrt, erf, erfc, exp2, hypot, lgamma and
// tgamma differ between x86-64 and arm64, and so do asin, atan, atan2, expm1, log1p, sinh, cosh, tan and tanh of float. In double
// exp, expm1, log, log1p, log2, log10, pow, fmod, remainder and the functions of angles are equal.

#include <cmath>

namespace wade {

// Returns the length of (x, y).
[[nodiscard]] inline double length_of(double x, double y) {
    return std::sqrt(x * x + y * y);
}
[[nodiscard]] inline float length_of(float x, float y) {
    return static_cast<float>(length_of(static_cast<double>(x), static_cast<double>(y)));
}

// Returns the cube root of x.
[[nodiscard]] double cube_root(double x);

// Returns the fraction of the normal values below z standard deviations.
[[nodiscard]] double normal_share(double z);

}  // namespace wade
