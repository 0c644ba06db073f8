#include "viscous_exact.hpp"

#include <cmath>
#include <numbers>

namespace wade::validation {

namespace {

constexpr double pi = std::numbers::pi;

// exp(-x) is below the last digit of a double from here on.
constexpr double negligible = 40;

// At t = 0 the series of the Couette flow does not converge at the moving plane and its terms fall as 1/n elsewhere.
constexpr int most_terms = 20000;

double square(double v) {
    return v * v;
}

}  // namespace

double poiseuille_velocity(double y, double t, double acceleration, double viscosity, double height) {
    double u = acceleration / (2 * viscosity) * y * (height - y);
    for (int n = 1; n < most_terms; n += 2) {
        const double decay = square(n * pi / height) * viscosity * t;
        if (decay > negligible) break;
        const double amplitude = 4 * acceleration * square(height) / (viscosity * pi * square(n * pi) * n);
        u -= amplitude * std::sin(n * pi * y / height) * std::exp(-decay);
    }
    return u;
}

double couette_velocity(double y, double t, double speed, double viscosity, double height) {
    double u = speed * y / height;
    for (int n = 1; n < most_terms; ++n) {
        const double decay = square(n * pi / height) * viscosity * t;
        if (decay > negligible) break;
        const double amplitude = (n % 2 == 0 ? 2 : -2) * speed / (n * pi);
        u += amplitude * std::sin(n * pi * y / height) * std::exp(-decay);
    }
    return u;
}

double taylor_green_decay(double t, double viscosity, double length) {
    return std::exp(-2 * viscosity * square(2 * pi / length) * t);
}

}  // namespace wade::validation
