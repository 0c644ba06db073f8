#pragma once
// What a step knows of each particle besides its state.

#include <array>
#include <cstddef>
#include <vector>

#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

// Arrays one number a particle, padded as those of Particles.
struct ParticleFields {
    std::vector<float> density;           // rho / rho_0
    std::vector<float> gx, gy, gz;        // sum_j g_ij, 1/m
    std::vector<float> inverse_diagonal;  // dt^2 / A_ii, m^2
    std::vector<float> source;            // right-hand side of the running solve
    std::vector<float> ax, ay, az;        // m/s^2

    explicit ParticleFields(std::size_t capacity)
        : density(padded(capacity)),
          gx(padded(capacity)),
          gy(padded(capacity)),
          gz(padded(capacity)),
          inverse_diagonal(padded(capacity)),
          source(padded(capacity)),
          ax(padded(capacity)),
          ay(padded(capacity)),
          az(padded(capacity)) {}
};

// A vector a particle, as arrays.
struct VectorArrays {
    float *x = nullptr, *y = nullptr, *z = nullptr;
};
struct ConstVectorArrays {
    const float *x, *y, *z;
    ConstVectorArrays(const float* xs, const float* ys, const float* zs) : x(xs), y(ys), z(zs) {}
    ConstVectorArrays(const VectorArrays& v) : x(v.x), y(v.y), z(v.z) {}  // NOLINT: a view of the same
};

// A symmetric 3 x 3 matrix a particle: the arrays of its entries xx, yy, zz, xy, xz, yz.
using MatrixArrays = std::array<float*, 6>;
using ConstMatrixArrays = std::array<const float*, 6>;

// dt^2 / A_ii from sum_j g_ij and sum_j |g_ij|^2; 0 for a particle alone, which has no pressure.
inline float inverse_of_diagonal(float gx, float gy, float gz, float squares) {
    return squares > 0 ? 1 / (gx * gx + gy * gy + gz * gz + squares) : 0;
}

}  // namespace wade::fluid
