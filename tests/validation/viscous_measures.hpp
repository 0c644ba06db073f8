#pragma once
// Measures that the cases of viscous flow share.

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "fluid_server/particles/particles.hpp"
#include "run.hpp"

namespace wade::validation {

// Thickness of a periodic slice, m: 9 spacings, three support radii of the wider kernel, the least that the loader allows.
double slice_thickness(const Request& request);

// Overrides that make a scene's periodic slice that thick along z, and along x as well if it is a slice there too.
std::vector<std::string> slice_overrides(const Request& request, bool along_x);

// Kinetic energy per mass of all particles, m^2/s^2.
double specific_kinetic_energy(const fluid::Particles& particles);

// Mean of rho / rho_0 - 1 where positive, and of its absolute value, of the densities of the last step; largest value.
struct DensityError {
    double compression = 0;
    double magnitude = 0;
    double largest = 0;
};
DensityError density_error(const fluid::FluidWorld& world);

// Adds what says how hard the pressure solves had to work: iterations a step, compression at the end.
void note_solver(const Cost& cost, const fluid::FluidWorld& world, Result& result);

// One component of the velocity at given points of the x-y plane, from the particles round them: moving least squares
// with linear functions, exact for linear fields up to the walls, and averaged over all frames that were added.
class PointSamples {
 public:
    // points: (x, y), m; component: 0 or 1; reach: radius round a point, m, two spacings at least
    PointSamples(std::vector<std::array<double, 2>> points, std::size_t component, double reach);

    void add(const fluid::Particles& particles);

    // Velocity at point k, m/s; NaN where too few particles came by.
    [[nodiscard]] double velocity(std::size_t k) const;

 private:
    // Weighted sums of 1, dx, dy, dx^2, dx dy, dy^2 and of u, u dx, u dy.
    using Sums = std::array<double, 9>;
    std::vector<std::array<double, 2>> points_;
    std::vector<Sums> sums_;
    std::size_t component_;
    double reach_;
};

}  // namespace wade::validation
