#pragma once
// Kernels with compact support radius h, in three dimensions, and their densities on a lattice of spacing d.
//
// The cubic spline (Monaghan 1992):
//
//   W(r, h) = 8 / (pi h^3) * { 6 (q^3 - q^2) + 1   for 0 <= q <= 1/2
//                            { 2 (1 - q)^3         for 1/2 < q <= 1,     q = r / h
//
// With h = 2 d a cubic lattice of spacing d has exactly its rest density: d^3 sum W = 1.000. With a larger support W is
// divided by that sum, 1.001 at 2.05 d and 1.004 at 2.2 d, so that the lattice has its rest density there too.
//
// Stretched by a small strain e at constant volume the lattice has the density 1 + s e^2. Held at rest density it must swell
// by s e^2 against the pressure: it resists shear like a solid with a stiffness of s times the pressure, at any
// spacing. Along an axis and along a diagonal s is
//
//   h / d    2 (e -> 0)    2 (e = 0.05)    2.05           2.1
//   s        0.068, 0.046  0.102, 0.044    0.000, 0.000   -0.072, -0.052
//
// The quartic spline M5 (Schoenberg 1946; Price 2012):
//
//   W(r, h) = 15625 / (512 pi h^3) * { (1 - q)_+^4 - 5 (3/5 - q)_+^4 + 10 (1/5 - q)_+^4 },   x_+ = max(0, x)
//
// With h = 2.4 d the density hardly depends on the packing of particles: s is 0.003 along an axis and -0.008 along a
// diagonal as e -> 0, 0.020 and -0.010 at e = 0.1, where the cubic spline has 0.126 and 0.041, and body-centred,
// face-centred and hexagonal packings of the same number of particles are less dense than the cubic lattice by 0.0007,
// 0.0001 and 0.0003 (the cubic spline: 0.0002, 0.0025, 0.0018). So the water has no preferred shape: waves have their
// speed, and still water does not settle into another packing. At 2.3 d s is 0.045 along an axis; at 2.5 d -0.002 and
// -0.011, for an eighth more neighbours. W is divided by its sum over the lattice, 1.0003.
//
// Wendland's C2 function (Wendland 1995, Dehnen and Aly 2012):
//
//   W(r, h) = 21 / (2 pi h^3) * (1 - q)^4 (1 + 4 q)
//
// With h = 3 d the lattice sum is 1.003; W is divided by it, so that the lattice has its rest density here too.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "configs/scene/fluid.hpp"
#include "configs/scene/scene.hpp"
#include "configs/scene/scene_capacity.hpp"

namespace wade::fluid {

// d^3 sum W over the cubic lattice of spacing d, of W = shape(q) / h^3 with h = ratio d.
template <typename Shape>
double lattice_sum(double ratio, Shape&& shape) {
    const int reach = static_cast<int>(std::ceil(ratio));
    double sum = 0;
    for (int i = -reach; i <= reach; ++i) {
        for (int j = -reach; j <= reach; ++j) {
            for (int k = -reach; k <= reach; ++k) {
                const double q = std::sqrt(static_cast<double>(i * i + j * j + k * k)) / ratio;
                sum += q < 1 ? shape(q) : 0;
            }
        }
    }
    return sum / (ratio * ratio * ratio);
}

class CubicSpline {
 public:
    // A flat free surface of the lattice has 0.85 of rest density, with a support of 2.2 d 0.82.
    static constexpr float open_surface_density = 0.8F;
    // Of the Jacobi iteration (Ihmsen et al. 2014). It converges below 2 / 2.82, the largest eigenvalue of the system over
    // its diagonal on the lattice; with a support of 2.2 d below 2 / 3.29.
    static constexpr float relaxation = 0.5F;

    // spacings: h / d. At 2 the sum over the lattice, 0.99997, is left as it is.
    explicit CubicSpline(float support_radius, double spacings = 2)
        : inverse_h_(1.0F / support_radius),
          norm_(8.0F * inverse_h_ * inverse_h_ * inverse_h_ / std::numbers::pi_v<float>) {
        if (spacings > 2) norm_ /= static_cast<float>(lattice_sum(spacings, shape));
    }

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
    static double shape(double q) {
        return 8 / std::numbers::pi * (q <= 0.5 ? 6 * q * q * (q - 1) + 1 : 2 * std::pow(1 - q, 3));
    }

    float inverse_h_;
    float norm_;
};

class QuarticSpline {
 public:
    // A flat free surface of the lattice has 0.825 of rest density.
    static constexpr float open_surface_density = 0.775F;
    // The largest eigenvalue is 3.20: the iteration converges below 2 / 3.20.
    static constexpr float relaxation = 0.5F;
    // Knots of the spline in q, and its shape at q = 0: the value, and minus the slope over q.
    static constexpr float knot_near = 0.2F, knot_far = 0.6F;
    static constexpr float value_at_zero = 0.368F, factor_at_zero = 4.8F;

    // spacings: h / d.
    QuarticSpline(float support_radius, double spacings)
        : inverse_h_(1.0F / support_radius),
          norm_(static_cast<float>(1 / lattice_sum(spacings, shape)) * inverse_h_ * inverse_h_ * inverse_h_) {}

    [[nodiscard]] float inverse_support_radius() const { return inverse_h_; }

    // W(r) in 1/m^3; r in m, r >= 0.
    [[nodiscard]] float value(float r) const {
        const float q = r * inverse_h_;
        const float u = std::max(0.0F, 1.0F - q), v = std::max(0.0F, knot_far - q), w = std::max(0.0F, knot_near - q);
        return norm_ * ((u * u) * (u * u) - 5.0F * (v * v) * (v * v) + 10.0F * (w * w) * (w * w));
    }

    // (dW/dr) / r in 1/m^5, finite at r = 0, so that grad W = (x_i - x_j) * gradient_factor(r).
    [[nodiscard]] float gradient_factor(float r) const {
        const float q = r * inverse_h_;
        const float near = factor_at_zero * (1.0F - 5.0F * q * q);
        const float u = std::max(0.0F, 1.0F - q), v = std::max(0.0F, knot_far - q);
        const float far = 4.0F * (u * u * u - 5.0F * v * v * v) / (q > knot_near ? q : 1.0F);
        return -norm_ * inverse_h_ * inverse_h_ * (q <= knot_near ? near : far);
    }

 private:
    // Without 15625 / (512 pi): the lattice's sum takes its place.
    static double shape(double q) {
        const auto piece = [q](double knot) { return std::pow(std::max(0.0, knot - q), 4); };
        return piece(1) - 5 * piece(0.6) + 10 * piece(0.2);
    }

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
          norm_(static_cast<float>(1 / lattice_sum(spacings, shape)) * inverse_h_ * inverse_h_ * inverse_h_) {}

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
    // Without 21 / (2 pi): the lattice's sum, 1.003 * 2 pi / 21, takes its place.
    static double shape(double q) { return std::pow(1 - q, 4) * (1 + 4 * q); }

    float inverse_h_;
    float norm_;
};

// - d^3 sum x^2 (dW/dr) / r over the cubic lattice of spacing d: 1 for a kernel that is fine against the lattice, 1.020 for
// the cubic spline at 2 d. The viscous operator is divided by it, so that it is exact for a parabola on the lattice.
template <typename AnyKernel>
double lattice_second_moment(const AnyKernel& kernel, double spacing) {
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

// The kernel of a scene, of its support radius.
using Kernel = std::variant<CubicSpline, QuarticSpline, WendlandC2>;
[[nodiscard]] inline Kernel make_kernel(const Fluid& fluid) {
    const auto h = static_cast<float>(support_radius_of(fluid));
    switch (fluid.kernel) {
        case KernelKind::quartic_spline:
            return QuarticSpline(h, support_in_spacings_of(fluid));
        case KernelKind::wendland_c2:
            return WendlandC2(h);
        case KernelKind::cubic_spline:
        case KernelKind::automatic:
            break;
    }
    return CubicSpline(h, support_in_spacings_of(fluid));
}

}  // namespace wade::fluid
