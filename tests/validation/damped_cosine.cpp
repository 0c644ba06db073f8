#include "damped_cosine.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

namespace wade::validation {

namespace {

// Sum of squares that the best linear part leaves.
double solve_linear(const std::vector<double>& times, const std::vector<double>& values, DampedCosine& fit) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    double squares = 0;
    for (std::size_t i = 0; i < times.size(); ++i) {
        const double decay = std::exp(-fit.damping * times[i]);
        const Eigen::Vector3d basis{decay * std::cos(fit.omega * times[i]), decay * std::sin(fit.omega * times[i]), 1};
        normal += basis * basis.transpose();
        right += basis * values[i];
        squares += values[i] * values[i];
    }
    const Eigen::Vector3d x = normal.ldlt().solve(right);
    fit.a = x[0], fit.b = x[1], fit.offset = x[2];
    return squares - x.dot(right);
}

}  // namespace

DampedCosine fit_damped_cosine(const std::vector<double>& times, const std::vector<double>& values,
                               double omega_guess) {
    // A grid of 31 x 31 that closes in round its best point by a factor of five, until it resolves 1e-6 of the guess.
    double omega = omega_guess, omega_range = 0.3 * omega_guess;
    double damping = 0.15 * omega_guess, damping_range = 0.35 * omega_guess;
    constexpr int half = 15;
    double least = std::numeric_limits<double>::infinity();
    DampedCosine best;
    while (omega_range > 1e-6 * omega_guess) {
        const double omega_centre = omega, damping_centre = damping;
        for (int i = -half; i <= half; ++i) {
            for (int j = -half; j <= half; ++j) {
                DampedCosine fit;
                fit.omega = omega_centre + omega_range * i / half;
                fit.damping = damping_centre + damping_range * j / half;
                const double squares = solve_linear(times, values, fit);
                if (squares < least) {
                    least = squares, best = fit;
                    omega = fit.omega, damping = fit.damping;
                }
            }
        }
        omega_range /= 5, damping_range /= 5;
    }
    best.residual = std::sqrt(std::max(0.0, least) / static_cast<double>(times.size())) / std::hypot(best.a, best.b);
    return best;
}

}  // namespace wade::validation
