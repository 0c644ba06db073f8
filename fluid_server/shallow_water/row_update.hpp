#pragma once
// Rows of cells from one state to the next one: an Euler step of a channel, a whole step of a site.
//
// The step of a site is that of MUSCL and Hancock (van Leer 1984, SIAM J. Sci. Stat. Comput. 5, 1; Toro 2001, Shock-Capturing
// Methods, section 11.5): half a step of each cell by its own slopes alone,
//
//   h* = h - dt/2 (u h_x + h u_x + v h_z + h v_z)
//   u* = (u - dt/2 (u u_x + v u_z + g eta_x)) / (1 + dt k/2),   v* alike,
//
// and a whole one by the fluxes between the profiles that so moved, U_new = (U + dt L(h*, u*, v*)) / (1 + dt k). Second order in
// space and time with one flux a face. Depths at the faces stay between 0 and 2 h, and what rests stays to the last bit.
// What the letters are: step.hpp; profiles and fluxes: face_flux.hpp; walls: openings.hpp.

#include <cstddef>

#include "fluid_server/shallow_water/face_flux.hpp"
#include "fluid_server/shallow_water/world.hpp"

namespace wade::fluid::shallow_water {

struct StageTerms {
    FluxConstants constants;
    double acceleration = 0;  // along x, m/s^2
    double manning_n = 0;     // s/m^(1/3)
    double share = 1;         // of the Euler step in the result; the rest is the base
    double dt = 0;            // s
    double discharge = 0;     // of the inflow, m^2/s
};

struct BandFrom {
    const RowMemory &qx, &qz;
    const Primitive& primitive;  // ghosts included
};
struct BandTo {
    RowMemory* h;  // null: only in the primitive
    RowMemory &qx, &qz;
    Primitive& primitive;  // without ghosts
};

// to = (1 - share) base + share (from + dt L(from)) / (1 + dt k) in rows [begin, end), the base the world's water.
// Writes what the world keeps by row. `to` may be qx and qz of `from`, and the world's primitive.
void update_band(ShallowWater& world, const BandFrom& from, const StageTerms& terms, std::size_t begin, std::size_t end,
                 RowMemory& buffer, const BandTo& to);

// From the world's `water` and `primitive` to its `stage` and `stage_primitive`, rows [begin, end) without ghosts, dt, s. Writes
// the smallest depths by row. Cells of groups get what each would have alone. Of a site.
void update_site_band(ShallowWater& world, double dt, std::size_t begin, std::size_t end, RowMemory& buffer);

}  // namespace wade::fluid::shallow_water
