#pragma once
// Two-level pressure solve for deep water: a correction on a coarse Cartesian grid for the long waves of the error.
//
// A Jacobi iteration (dfsph.hpp) carries pressure no further than a support radius, so that water of n layers takes
// iterations in the order of n. The error that it leaves is smooth and needs few unknowns: one at each node of a grid
// with cells a few spacings long (two-grid iteration, Brandt 1977; with the Galerkin coarse matrix, which needs no
// discretisation of its own at the surface).
//
// W13. Let G p be the accelerations a_i(p) of W7. Sums over pairs are antisymmetric, so that the density rate of a velocity is
// D = -G^T but for velocities that are given, and the system of W8 is
//
//   A p = b,   A = -dt^2 D G = dt^2 G^T G,
//
// symmetric, and positive but for a pressure that moves nothing. Among all pressures p + sum_k e_k P_k the one nearest
// to the solution, in the energy norm of the error, has a residual orthogonal to each P_k (Galerkin). With the residual
// r = b - A p of p,
//
//   sum_l (P_k . A P_l) e_l = P_k . r,   P_k . A P_l = dt^2 sum_i (G P_k)_i . (G P_l)_i.
//
// P_k is the trilinear hat N_k of node k where the water has pressure, m_i = 1, and zero elsewhere, m_i = 0. With the hat at a
// neighbour to first order, N_k(x_j) = N_k(x_i) + grad N_k . (x_j - x_i), and sum_j (x_j - x_i) (x) g_ij = 1, which
// holds inside of the water (compare W4),
//
//   (G P_k)_i = - sum_j (m_i N_k(x_i) + m_j N_k(x_j)) g_ij
//             ~ - ( N_k(x_i) c_i + m_i grad N_k(x_i) ),     c_i = m_i sum_j g_ij + sum_j m_j g_ij.
//
// c_i is exact, vanishes inside and points out of the water at its surface: there a hat that does not vanish is a jump
// of the pressure to zero, and c_i brings the free surface into the matrix. Particles with a prescribed velocity have
// no row in G.
//
// A node with less water than a fraction of that of an interior node is left out, e_k = 0. In the gradients of a few
// particles c_i N_k + grad N_k may cancel; the matrix is then singular, and its solution ejects these particles.
//
// The matrix couples a node to its 26 neighbours. It is solved by conjugate gradients, with the vertical lines of nodes, along
// which the weight of the water goes down, solved exactly as preconditioner.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "configs/scene/scene.hpp"
#include "fluid_server/particles/particle_fields.hpp"
#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

// The cells over the water; each has a node at its corners.
class CoarseGrid {
 public:
    static constexpr std::size_t corners = 8;  // bit 0: along x, 1: along y, 2: along z
    using Hats = std::array<float, corners>;   // N_k of the corners of a cell

    explicit CoarseGrid(const Scene& scene);

    // Whether the channel is one that a grid with a bed and a surface fits.
    [[nodiscard]] bool fits() const { return !periodic_[1]; }

    // Lays the grid over the particles and sorts them by cell. False if the water fills so little of the box round it that
    // cells would take more memory and time than they are worth.
    bool place(const Particles& particles);

    // Numbers of the nodes at the corners of a cell, how much water a node has when it is all inside.
    [[nodiscard]] std::array<std::uint32_t, corners> nodes_of(std::size_t cell) const;
    // A particle, and how far along each axis it is within its cell, 0 to 1.
    struct Inside {
        std::uint32_t i;
        std::array<float, 3> way;
    };
    [[nodiscard]] std::span<const Inside> particles_in(std::size_t cell) const {
        return {inside_.data() + start_[cell], inside_.data() + start_[cell + 1]};
    }
    [[nodiscard]] float full_node(std::size_t i, std::size_t j, std::size_t k) const;

    [[nodiscard]] std::size_t particles() const { return inside_.size(); }
    [[nodiscard]] std::size_t cells() const { return cells_[0] * cells_[1] * cells_[2]; }
    [[nodiscard]] std::size_t nodes() const { return nodes_[0] * nodes_[1] * nodes_[2]; }
    [[nodiscard]] std::size_t nodes_along(std::size_t axis) const { return nodes_[axis]; }
    [[nodiscard]] bool wraps(std::size_t axis) const { return periodic_[axis]; }
    // Nodes of a vertical line follow one another.
    [[nodiscard]] std::size_t node(std::size_t i, std::size_t j, std::size_t k) const {
        return (k * nodes_[0] + i) * nodes_[1] + j;
    }
    [[nodiscard]] float cells_a_metre(std::size_t axis) const { return inverse_[axis]; }

 private:
    struct Box {
        std::array<float, 3> lo{}, hi{};
    };
    [[nodiscard]] Box box_of(const Particles& particles) const;
    bool cut(const Box& box, float cell, std::size_t particles);
    void sort(const Particles& particles);

    float spacing_;
    std::array<bool, 3> periodic_{};
    Box channel_;
    std::array<std::array<bool, 2>, 3> walls_{};  // whether the box over the water ends at one, below and above
    std::array<float, 3> lo_{}, inverse_{};
    std::array<std::size_t, 3> cells_{}, nodes_{};
    std::vector<std::uint32_t> cell_of_, start_;
    std::vector<Inside> inside_;  // by cell
};

// A_c e = r_c.
class CoarsePressure {
 public:
    explicit CoarsePressure(const Scene& scene) : grid_(scene) {}

    [[nodiscard]] bool fits() const { return grid_.fits(); }
    bool place(const Particles& particles) { return grid_.place(particles); }

    // The matrix over dt^2. mask: m; open: c.
    void build(const Particles& particles, const std::vector<float>& mask, const ConstVectorArrays& open);

    // Puts the correction of each particle, dt^2 sum_k e_k N_k(x_i), in the place of its residual, which is zero where m = 0. Returns the
    // compression that nodes see before, summed over particles: that of single particles, which has no sign, cancels.
    double solve(std::vector<float>& residual);

 private:
    static constexpr std::size_t corners = CoarseGrid::corners;
    using Element = std::array<float, corners * corners>;  // what the particles of one cell add to the matrix
    using Row = std::array<float, 27>;                     // [9 (dz + 1) + 3 (dx + 1) + dy + 1]

    [[nodiscard]] Element element_of(std::size_t cell, const Particles& particles, const std::vector<float>& mask,
                                     const ConstVectorArrays& open) const;
    void add(const Element& element, std::size_t cell);
    // sum_i q_i N_k(x_i) for each node; and sum_k e_k N_k(x_i) for each particle.
    void restrict_to_nodes(const std::vector<float>& q, std::vector<float>& sums);
    void interpolate_at_particles(const std::vector<float>& e, std::vector<float>& q) const;
    void leave_out_thin_nodes(const std::vector<float>& mask);
    void eliminate_lines();
    void multiply(const std::vector<float>& e, std::vector<float>& out) const;
    void solve_lines(const std::vector<float>& r, std::vector<float>& z) const;
    void solve_by_conjugate_gradients();

    CoarseGrid grid_;
    std::vector<CoarseGrid::Hats> at_corners_;  // sums of each cell
    std::vector<Element> elements_;             // of a few cells at a time
    std::vector<Row> rows_;
    std::vector<float> in_use_;        // 1, or 0 for a node that is left out
    std::vector<float> line_inverse_;  // of the diagonal, once what is below is eliminated
    std::vector<float> e_, r_, z_, d_, q_;
};

}  // namespace wade::fluid
