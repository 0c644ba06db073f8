#pragma once
// Fit of a damped oscillation.

#include <vector>

namespace wade::validation {

// x(t) = exp(-damping t) (a cos(omega t) + b sin(omega t)) + offset
struct DampedCosine {
    double omega = 0;    // rad/s
    double damping = 0;  // 1/s
    double a = 0, b = 0, offset = 0;
    double residual = 0;  // RMS over the amplitude at t = 0
};

// Least squares: omega within 30 % of the guess, damping from -0.2 to 0.5 of it; the rest is linear.
DampedCosine fit_damped_cosine(const std::vector<double>& times, const std::vector<double>& values, double omega_guess);

}  // namespace wade::validation
