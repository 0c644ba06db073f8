#pragma once
// Sums over neighbours and images for all particles of one block: the only code that knows about vector lanes. It is
// compiled for several instruction sets, and the best that the processor has is chosen at run time.
//
// Terms (dfsph.hpp): g_ij = V grad W_ij; x~ and g~ as in neighbours.hpp. Arrays are written for whole clusters, so that a
// few entries beyond the last particle change (particles.hpp, padded).

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "fluid_server/neighbours/kernel.hpp"
#include "fluid_server/neighbours/neighbour_lists.hpp"
#include "fluid_server/particles/particle_fields.hpp"

namespace wade::fluid {

// What the first sweep finds of each particle.
struct KernelSums {
    float* density;         // V sum_j W_ij, fraction of rest density
    VectorArrays gradient;  // sum_j g_ij, 1/m
    float* squares;         // sum_j |g_ij|^2, 1/m^2
    VectorArrays
        shear;  // sum_j (v_i - v_j) V (dW/dr) / r, 1/(m s), by the velocities that viscosity sees of images; or null
};

// Computes the factors of the block's lists, and the sums that go with them. volume: V, m^3. Viscosity's sum is among them as
// a sweep of its own would cost twice as much.
void sum_kernel(std::size_t block, const Particles& particles, const Kernel& kernel, float volume,
                NeighbourLists& lists, const KernelSums& sums);

// sum_j q_j g_ij of a scalar q.
void sum_gradients(std::size_t block, const Particles& particles, const NeighbourLists& lists, const float* scalar,
                   const VectorArrays& sums);

// sum_j u_j . (R g_ij) of a vector u, for an image R g the gradient that its mirrored velocity meets; block_size sums.
void sum_divergence(std::size_t block, const Particles& particles, const NeighbourLists& lists,
                    const ConstVectorArrays& u, float* sums);

// Both of these in one sweep.
void sum_gradients_and_divergence(std::size_t block, const Particles& particles, const NeighbourLists& lists,
                                  const float* scalar, const VectorArrays& gradients, const ConstVectorArrays& u,
                                  float* divergences);

// - sum_j (x_i - x_j) (x) g_ij, for an image x_j its place.
void sum_moments(std::size_t block, const Particles& particles, const NeighbourLists& lists, const MatrixArrays& sums);

// The same sums with g_ij replaced by (L_i + L_j) g_ij / 2, L_j that of the image for an image.
void sum_corrected_kernel(std::size_t block, const Particles& particles, const NeighbourLists& lists,
                          const ConstMatrixArrays& l, const VectorArrays& gradient, float* squares);
void sum_corrected_gradients(std::size_t block, const Particles& particles, const NeighbourLists& lists,
                             const ConstMatrixArrays& l, const float* scalar, const VectorArrays& sums);
void sum_corrected_divergence(std::size_t block, const Particles& particles, const NeighbourLists& lists,
                              const ConstMatrixArrays& l, const ConstVectorArrays& u, float* sums);

// The instruction set in use, such as "AVX3".
[[nodiscard]] std::string_view instruction_set();

// From now on as a processor without AVX-512 would do it, with vectors of 8 lanes; true: with whatever the processor has. The bits
// are the same.
void use_widest_vectors(bool widest);

}  // namespace wade::fluid
