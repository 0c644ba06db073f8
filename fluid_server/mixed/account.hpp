#pragma once
// What water has passed between the particles and the grid, and what one owes the other.
//
// The water of a mixed scene is, in m^3,
//
//   all = grid outside the window + sum_i V_i S(x_i) + owed,    S: 1 in the window, 0 outside, from 0 to 1 over one spacing
//                                                               round its open ends, as a particle is a cube d long
//
// Through an end of the window the grid gives the flux F of its face and the particles take sum V_i dS_i; the difference is
// owed. The part 1 - exp(-dt / T) of it is paid in each step: the cells before that end, as far as the guard reaches, become
// deeper or shallower by the same share and keep their velocity. So `all` changes by what enters and leaves the channel, to
// rounding, and `owed` is the error at any moment: single particles pass, the grid's flux is smooth.

#include <array>
#include <cstddef>

#include "fluid_server/mixed/guard.hpp"
#include "fluid_server/mixed/window.hpp"
#include "fluid_server/particles/particles.hpp"
#include "fluid_server/shallow_water/step.hpp"

namespace wade::fluid::mixed {

// Of one end of the window, since t = 0. Volumes, m^3; momenta along x that the water carries with it, over density, m^4/s.
struct EndAccount {
    double owed = 0;                                  // to the grid
    double most_owed = 0;                             // largest |owed|
    double passed = 0;                                // sum of |F| dt
    double grid_momentum = 0, particle_momentum = 0;  // sums of what passed towards +x
    double passed_momentum = 0;                       // sum of |momentum| by the grid
};

// How much of a particle at x counts to the window, [0, 1].
[[nodiscard]] inline double share_in_window(double x, const std::array<End, 2>& ends, double spacing) {
    double share = 1;
    for (const End& end : ends) {
        if (end.open) share = std::min(share, std::clamp(0.5 - end.s_of(x) / spacing, 0.0, 1.0));
    }
    return share;
}

// Sum of V_i S_i, m^3.
[[nodiscard]] double volume_in_window(const Particles& particles, const std::array<End, 2>& ends, double spacing);

// Of the grid's cells [begin, end) along x, m^3.
[[nodiscard]] double volume_of_cells(const shallow_water::ShallowWater& world, std::size_t begin, std::size_t end);

// Multiplies depth and flow of the cells [begin, end) along x by one factor, at most by a tenth up or down, so that their
// volume grows by `wanted` m^3, if possible; returns by how much it grew.
double add_to_cells(shallow_water::ShallowWater& world, std::size_t begin, std::size_t end, double wanted);

}  // namespace wade::fluid::mixed
