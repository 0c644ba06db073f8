#pragma once
// Boundary conditions of the grid.
//
//   x.lo  emitter: an outfall; closed: a wall; recirculating, periodic: the other end
//   x.hi  emitter: an inflow of given discharge; else as x.lo
//   z     a wall on each side, or the other side
//
// A wall is a mirror: its ghost cells are the images of the cells before it. At the outfall supercritical water leaves
// unchanged. Subcritical water speeds up to critical flow at the edge, u + 2 c = 3 c_critical along the wave that comes
// from upstream. The inflow brings the discharge v_F * depth. Where v_F is above the wave speed of channel.depth it
// comes in with that depth, unless the water before it stands so high that it drowns the opening. Else its depth
// follows from the wave that runs upstream, u - 2 c constant, and is not less than the critical one.

#include <vector>

#include "fluid_server/shallow_water/face_flux.hpp"
#include "fluid_server/shallow_water/grid.hpp"
#include "fluid_server/shallow_water/site/wet_lines.hpp"

namespace wade::fluid::shallow_water {

// The state by cell that fluxes are made from, ghosts included.
struct Primitive {
    RowMemory h;     // depth, m
    RowMemory eta;   // height of the surface, m; empty on a level bed, see surface()
    RowMemory u, v;  // velocity along x and across, m/s

    Primitive(const Grid& grid, const Bed& bed)
        : h(grid.stored(), 0), eta(bed.level ? 0 : grid.stored(), 0), u(grid.stored(), 0), v(grid.stored(), 0) {}

    // Over a level bed the surface is as high as the water is deep.
    [[nodiscard]] const RowMemory& surface() const { return eta.empty() ? h : eta; }
};

// Cells from place c on, with u or v as the velocity normal to the faces.
inline Cells along_x(const Primitive& p, std::size_t c) {
    return {p.h.data() + c, p.surface().data() + c, p.u.data() + c, p.v.data() + c};
}
inline Cells across(const Primitive& p, std::size_t c) {
    return {p.h.data() + c, p.surface().data() + c, p.v.data() + c, p.u.data() + c};
}

// Fills the ghost cells, those beside lines that are active; at the ends of rows [begin, end) only.
void fill_ghosts(Primitive& state, const Grid& grid, const Channel& channel, double gravity, const Lines& active,
                 std::size_t begin, std::size_t end);

// Depth, m, and velocity along x, m/s, before a fall become those below it.
void fall(double& h, double& u, double gravity);

// Depth at the inflow, m. discharge: per width, >= 0, m^2/s; nozzle_depth: of the opening, m; h, u: in the cell before it,
// u > 0 downstream.
[[nodiscard]] double inflow_depth(double discharge, double nozzle_depth, double h, double u, double gravity);

// Replaces the flux through the last face of a row, at x.hi, by that of the inflow. h, u: of the row's last cell, along +x.
void set_inflow(const FluxRow& flux, std::size_t face, double discharge, double nozzle_depth, double h, double u,
                double gravity);

}  // namespace wade::fluid::shallow_water
