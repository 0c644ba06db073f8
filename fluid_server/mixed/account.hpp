#pragma once
// Exchange of water between the particles and the grid, and the conservation error that one owes the other.
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

// Momentum in a recirculating channel with people that push is conserved as well. The momentum of all water along x
// changes by the driving force and by what people take,
//
//   expected += a dt V - J / rho,      owed = expected - grid outside the window - sum_i V_i S(x_i) u_i,      over density, m^4/s
//
// and 1 - exp(-dt / T) of what is owed is paid to the cells before both ends in equal parts. Without it the fluxes of the two, a
// depth apart by 1 mm, differ by 10 N/m, as much as a person takes of 15 m of river.

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

// Of all water of a recirculating channel, along x over density, m^4/s.
struct MomentumBook {
    bool kept = false;
    double expected = 0;
    double owed = 0, most_owed = 0;
};

// Whether nothing but its driving and its people gives the water of a scene momentum along x: then the book is kept, if they push.
[[nodiscard]] bool keeps_momentum(const Scene& scene);

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

// Momentum along x over density, m^4/s: sum of V_i S_i u_i, and of the grid's cells [begin, end).
[[nodiscard]] double momentum_in_window(const Particles& particles, const std::array<End, 2>& ends, double spacing);
[[nodiscard]] double momentum_of_cells(const shallow_water::ShallowWater& world, std::size_t begin, std::size_t end);

// Gives the water of the cells [begin, end) along x one more velocity, together `amount` m^4/s; false if they are dry.
bool add_momentum_to_cells(shallow_water::ShallowWater& world, std::size_t begin, std::size_t end, double amount);

// Multiplies depth and flow of the cells [begin, end) along x by one factor, at most by a tenth up or down, so that their
// volume grows by `wanted` m^3, if possible; returns by how much it grew.
double add_to_cells(shallow_water::ShallowWater& world, std::size_t begin, std::size_t end, double wanted);

}  // namespace wade::fluid::mixed
