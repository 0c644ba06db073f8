#pragma once
// Divergence-free SPH (Bender and Koschier 2015, 2017) with the split of Cornelis et al. (2019): two pressure solves a
// step. The first keeps the velocity field free of divergence against all forces; its pressure is that of the water. The
// second keeps the density at rest density and moves positions only, so that correcting the packing of the particles
// neither drives nor brakes the flow. Without the first, the second moves both.
//
// Both solve the same linear system for pressures p >= 0 (divided by rest density, m^2/s^2) by relaxed Jacobi
// iterations; they differ in the source term only. With g_ij = V grad W_ij, sums over neighbours and images:
//
//   acceleration   a_i(p) = - sum_j (p_i + p_j) g_ij
//   density rate   D_i(u) =   sum_j (u_i - R u_j) . g_ij      R u_j: the mirrored velocity of an image
//   system         -dt^2 D_i(a(p)) = dt D_i(u) + c_i
//   density solve      c_i = rho_i/rho_0 - 1
//   divergence solve   c_i = s min(0, rho_i/rho_0 - 1): water that was loosened may fall back, the share s of its gap in a
//                      step; particles with an open side are left alone
//   diagonal       A_ii = dt^2 ( |sum_j g_ij|^2 + sum_j |g_ij|^2 )
//
// Each iteration finds short waves of the pressure at once and long ones late. Where water has many layers of particles the
// divergence solve adds those from a coarse grid (coarse_pressure.hpp).
//
// A sweep finds sum_j p_j g_ij or sum_j u_j . (R g_ij) (sweeps.hpp; R is symmetric); the share of i itself follows from
// sum_j g_ij, which is found once a step.

#include <algorithm>
#include <array>
#include <vector>

#include "configs/scene/fluid.hpp"
#include "configs/scene/scene.hpp"
#include "fluid_server/dfsph/coarse_pressure.hpp"
#include "fluid_server/neighbours/gradient_correction.hpp"
#include "fluid_server/neighbours/neighbours.hpp"
#include "fluid_server/particles/parallel.hpp"
#include "fluid_server/particles/particle_fields.hpp"
#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

struct SolveResult {
    int iterations = 0;
    int sweeps = 0;    // over all pairs
    double error = 0;  // mean predicted compression left: fraction of rest density
};

// Gives dt times the accelerations of the last solve to the velocities.
void apply_acceleration(Particles& particles, const ParticleFields& fields, float dt);

// Density, sum of gradients and diagonal of each particle, and the factors of the lists. volume: V, m^3. viscous: the sums of
// viscosity too (viscosity.hpp), into fields.ax, ay, az, by the velocities of now.
void compute_density_and_diagonal(const Particles& particles, const Kernel& kernel, float volume, bool viscous,
                                  NeighbourLists& lists, ParticleFields& fields);

// Force on bed and obstacles, N, downwards, by the pressures of the last step, once it has moved the particles: what they
// push against their images. A lid's is subtracted.
double bed_pressure_force(const Particles& particles, const NeighbourLists& lists, double particle_mass);

// Force on the faces of one obstacle, or the walls of one house, N, by the pressures of the last step and, if viscosity > 0, by viscosity at the
// velocities that the particles have now.
std::array<double, 3> obstacle_force(const Particles& particles, const NeighbourLists& lists, double particle_mass,
                                     double viscosity, int obstacle);

// What both solves of a step work on, at the places of its begin.
struct PressureSystem {
    Particles& particles;
    const NeighbourLists& lists;
    const GradientCorrection* correction;  // of the gradients of confined water, or null
    ParticleFields& fields;
};

// What the density solve is for.
enum class DensitySolve {
    positions,  // after a divergence solve: its accelerations move particles and leave no trace in their velocities
    velocities  // alone: they are those of the water
};

class PressureSolver {
 public:
    // open_surface_density: below this density, as a fraction, a particle has an open side and may be compressed: the
    //     divergence solve leaves it alone.
    // relaxation: of the Jacobi iteration.
    // confined: the water fills its space and has no open side. The pressure is then known up to a constant and the
    //     system can only be solved for sources with zero mean. The mean of the sources, that of an SPH density over
    //     disordered particles, is subtracted.
    // inflow_is_carried: Kind::inflow is carried by a stream that gives it velocity and pressure. The solve that finds
    //     velocities keeps that pressure: particles that cannot yield would gather more and more of it, and burst into
    //     those beside them that can. The density solve, where it moves positions only, moves Kind::inflow as well: its
    //     packing follows the stream. Else Kind::inflow is the lattice of an emitter, and the density solve does not mind
    //     how dense that is: where it is denser than rest it cannot yield, so that a pressure against it would grow for
    //     ever, and burst once a particle is let go.
    PressureSolver(const Scene& scene, float open_surface_density, float relaxation, bool confined,
                   bool inflow_is_carried)
        : open_surface_density_(confined ? 0 : open_surface_density),
          relaxation_(relaxation),
          confined_(confined),
          inflow_is_carried_(inflow_is_carried),
          long_waves_(scene) {}

    // Layers of particles in the deepest water from now on, 1 before. What each of n layers yields adds up to an error
    // n d tolerance / dt of the velocity above; held against g dt, what weight gives in a step of a fixed CFL number, it grows
    // with n squared. So beyond ten layers the tolerance of the divergence solve shrinks with their square; under a lid
    // weight moves nothing.
    void set_layers(double layers) { layers_ = confined_ ? 1 : std::max(1.0, layers); }

    // Corrects the velocities until no particle that is near rest density is being compressed.
    // step_share: dt over a step of CFL 0.5, at most 1. The tolerance, a change of density, is meant for such a step, and
    //     so is the gap that may be closed, so that shorter steps are not less exact.
    SolveResult solve_divergence(const PressureSystem& system, float dt, float step_share,
                                 const PressureSolve& settings);

    // Finds accelerations fields.ax, ay, az such that the densities after dt do not exceed rest density. Leaves the
    // velocities as they are.
    SolveResult solve_density(const PressureSystem& system, DensitySolve what, float dt, const PressureSolve& settings);

 private:
    // What Kind::inflow is to a solve.
    enum class Inflow {
        rigid,  // keeps its velocity
        given,  // keeps its velocity and its pressure
        free    // moves as all
    };
    struct Task {
        std::vector<float>& pressure;  // over rest density, m^2/s^2: that of the last step, and then of this one
        float warm_start;              // share of the former that it starts from
        float dt;                      // s
        Inflow inflow;
        PressureSolve settings;
        bool two_levels = false;  // with long waves from the coarse grid, which has been placed
        double tolerance_of_long_waves = 0;
    };
    // source(i, D_i(u)): the right-hand side, u the velocities that the particles have.
    template <typename Source>
    SolveResult solve(const PressureSystem& system, const Task& task, Source&& source);
    void subtract_mean(std::vector<float>& source, std::size_t n);
    // The long waves of a divergence solve: whether there are any, what they are made of, and how they change found_. The last returns
    // their share of the compression that is left, summed over particles.
    using BlockOf = std::array<float, block_size>;  // one number for each particle of a block
    bool place_long_waves(const Particles& particles, const PressureSolve& settings);
    void note_for_long_waves(const Particles& particles, std::size_t begin, std::size_t end, bool first,
                             const BlockOf& errors, const BlockOf& found);
    void build_long_waves(const PressureSystem& system);
    double find_long_waves(const Particles& particles, float dt2);

    float open_surface_density_;
    float relaxation_;
    bool confined_;
    bool inflow_is_carried_;
    double layers_ = 1;
    BlockSums<double> errors_;
    BlockSums<double> turns_;     // by how much momentum leads back
    std::vector<float> earlier_;  // pressure of the iteration before, where there is momentum
    CoarsePressure long_waves_;
    // With two levels: 1 where the coarse grid may change the pressure, or 0; the residual there, 0 elsewhere; the pressure that an
    // iteration finds.
    std::vector<float> may_change_, residual_, found_;
};

}  // namespace wade::fluid
