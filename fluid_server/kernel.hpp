#pragma once
// Kernels with compact support radius h, in three dimensions, and how dense they see a lattice of spacing d.
//
// The cubic spline (Monaghan 1992):
//
//   W(r, h) = 8 / (pi h^3) * { 6 (q^3 - q^2) + 1   for 0 <= q <= 1/2
//                            { 2 (1 - q)^3         for 1/2 < q <= 1,     q = r / h
//
// With h = 2 d a cubic lattice of spacing d has exactly its rest density: d^3 sum W = 1.000.
//
// Wendland's C2 function (Wendland 1995, Dehnen and Aly 2012):
//
//   W(r, h) = 21 / (2 pi h^3) * (1 - q)^4 (1 + 4 q)
//
// With h = 3 d the lattice sum is 1.003; W is divided by it, so that the lattice has its rest density here too.

#include <cmath>
#include <numbers>

namespace wade::fluid {

class CubicSpline {
 public:
    // A flat free surface of the lattice has 0.85 of rest density.
    static constexpr float open_surface_density = 0.8F;
    // Of the Jacobi iteration (Ihmsen et al. 2014). It converges below 2 / 2.82, the largest eigenvalue of the system over
    // its diagonal on the lattice.
    static constexpr float relaxation = 0.5F;

    explicit CubicSpline(float support_radius)
        : inverse_h_(1.0F / support_radius),
          norm_(8.0F * inverse_h_ * inverse_h_ * inverse_h_ / std::numbers::pi_v<float>) {}

    [[nodiscard]] float inverse_support_radius() const { return inverse_h_; }

    // W(r) in 1/m^3; r in m, r >= 0.
    [[nodiscard]] float value(float r) const {
        const float q = r * inverse_h_;
        const float near = 6.0F * q * q * (q - 1.0F) + 1.0F;
        const float u = 1.0F - q;
        const float far = 2.0F * u * u * u;
        const float w = q <= 0.5F ? near : far;
        return q < 1.0F ? norm_ * w : 0.0F;
    }

    // (dW/dr) / r in 1/m^5, finite at r = 0, so that grad W = (x_i - x_j) * gradient_factor(r).
    [[nodiscard]] float gradient_factor(float r) const {
        const float q = r * inverse_h_;
        const float near = 18.0F * q - 12.0F;
        const float u = 1.0F - q;
        const float far = -6.0F * u * u / (q > 0.5F ? q : 1.0F);
        const float w = q <= 0.5F ? near : far;
        return q < 1.0F ? norm_ * inverse_h_ * inverse_h_ * w : 0.0F;
    }

 private:
    float inverse_h_;
    float norm_;
};

class WendlandC2 {
 public:
    // A flat free surface of the lattice has 0.77 of rest density.
    static constexpr float open_surface_density = 0.72F;
    // The largest eigenvalue is 6.25: as far below 2 / 6.25 as the cubic spline's below its limit.
    static constexpr float relaxation = 0.22F;
    static constexpr int spacings = 3;  // h / d

    explicit WendlandC2(float support_radius)
        : inverse_h_(1.0F / support_radius),
          norm_(static_cast<float>(1 / lattice_sum()) * inverse_h_ * inverse_h_ * inverse_h_) {}

    [[nodiscard]] float inverse_support_radius() const { return inverse_h_; }

    // W(r) in 1/m^3; r in m, r >= 0.
    [[nodiscard]] float value(float r) const {
        const float q = r * inverse_h_;
        const float u = 1.0F - q;
        return q < 1.0F ? norm_ * (u * u) * (u * u) * (1.0F + 4.0F * q) : 0.0F;
    }

    // (dW/dr) / r in 1/m^5, so that grad W = (x_i - x_j) * gradient_factor(r).
    [[nodiscard]] float gradient_factor(float r) const {
        const float q = r * inverse_h_;
        const float u = 1.0F - q;
        return q < 1.0F ? -20.0F * norm_ * inverse_h_ * inverse_h_ * (u * u * u) : 0.0F;
    }

 private:
    // d^3 sum W / norm over the cubic lattice, so that norm = 1 / it makes the sum 1: 1.003 * 2 pi / 21.
    static double lattice_sum() {
        double sum = 0;
        for (int i = -spacings; i <= spacings; ++i) {
            for (int j = -spacings; j <= spacings; ++j) {
                for (int k = -spacings; k <= spacings; ++k) {
                    const double q = std::sqrt(static_cast<double>(i * i + j * j + k * k)) / spacings;
                    sum += q < 1 ? std::pow(1 - q, 4) * (1 + 4 * q) : 0;
                }
            }
        }
        return sum / (spacings * spacings * spacings);
    }

    float inverse_h_;
    float norm_;
};

// - d^3 sum x^2 (dW/dr) / r over the cubic lattice of spacing d: 1 for a kernel that is fine against the lattice, 1.020 for
// the cubic spline at 2 d. The viscous operator is divided by it, so that it is exact for a parabola on the lattice.
template <typename Kernel>
double lattice_second_moment(const Kernel& kernel, double spacing) {
    constexpr int reach = 3;
    double sum = 0;
    for (int i = -reach; i <= reach; ++i) {
        for (int j = -reach; j <= reach; ++j) {
            for (int k = -reach; k <= reach; ++k) {
                const double r = spacing * std::sqrt(static_cast<double>(i * i + j * j + k * k));
                if (r > 0) {
                    sum -= i * i * static_cast<double>(kernel.gradient_factor(static_cast<float>(r)));
                }
            }
        }
    }
    return sum * std::pow(spacing, 5);
}

}  // namespace wade::fluid
