#pragma once
// The cubic spline kernel (Monaghan 1992) with compact support radius h, in three dimensions:
//
//   W(r, h) = 8 / (pi h^3) * { 6 (q^3 - q^2) + 1   for 0 <= q <= 1/2
//                            { 2 (1 - q)^3         for 1/2 < q <= 1,     q = r / h
//
// With h = 2 d a cubic lattice of spacing d has exactly its rest density: d^3 sum W = 1.000.

#include <numbers>

namespace wade::fluid {

class CubicSpline {
 public:
    explicit CubicSpline(float support_radius)
        : inverse_h_(1.0F / support_radius),
          norm_(8.0F * inverse_h_ * inverse_h_ * inverse_h_ / std::numbers::pi_v<float>) {}

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

}  // namespace wade::fluid
