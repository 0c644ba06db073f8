#pragma once
// Rows of cells from one state to the next one, by the method of MUSCL and Hancock (van Leer 1984, SIAM J. Sci. Stat. Comput. 5,
// 1; Toro 2001, Shock-Capturing Methods, section 11.5): half a step of each cell by its own slopes alone,
//
//   h* = h - dt/2 (u h_x + h u_x + v h_z + h v_z)
//   u* = (u - dt/2 (u u_x + v u_z + g eta_x - a)) / (1 + dt k/2),   v* alike without a,
//
// and a whole one by the fluxes between the profiles that so moved, U_new = (U + dt L(h*, u*, v*)) / (1 + dt k). Second order in
// space and time with one flux a face. Depths at the faces stay between 0 and 2 h, and what rests stays to the last bit.
// Beyond an end or a side lies the image of the moved profile before it, or what it becomes at a fall; periodic ones have the
// profile of the other end.
// What the letters are: step.hpp; profiles and fluxes: face_flux.hpp; walls: openings.hpp.

#include <cstddef>

#include "fluid_server/shallow_water/face_flux.hpp"
#include "fluid_server/shallow_water/world.hpp"

namespace wade::fluid::shallow_water {

// From the world's `water` and `primitive` to its `stage` and `stage_primitive`, rows [begin, end) without ghosts, dt, s. Writes
// what the world keeps by row. Cells of groups get what each would have alone. discharge: of the emitter's inflow, m^2/s.
void update_band(ShallowWater& world, double dt, double discharge, std::size_t begin, std::size_t end,
                 RowMemory& buffer);

}  // namespace wade::fluid::shallow_water
