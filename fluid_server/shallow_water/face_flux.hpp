#pragma once
// Reconstruction and Riemann solver: from cells to the flux through the faces between them. This file has the rows that
// these read and write, face_flux-inl.hpp the formulas.
//
// Each cell has linear profiles of depth h, surface eta = h + b and velocity. At a face they give a state on the lower
// side, l, and on the upper side, r; the two beds may differ. The hydrostatic reconstruction (Audusse, Bouchut,
// Bristeau, Klein and Perthame 2004, SIAM J. Sci. Comput. 25, Eq. 2.11 to 2.16) lets both stand on the higher bed,
//
//   b* = max(b_l, b_r),   h*_l = max(0, eta_l - b*),   h*_r = max(0, eta_r - b*),
//
// and the flux of these states through the face is that of Harten, Lax and van Leer (1983) with the wave speeds of two
// rarefactions, or of a front on dry ground (Toro 2001, Shock-Capturing Methods, sections 10.4 and 10.6); momentum along
// the face goes with the mass, as in HLLC. Slopes are those of the monotonised central limiter (van Leer 1977).
//
// The momentum that a cell gets across its face is written without the hydrostatic pressure of its own side, F - g h*^2/2:
// what the reconstruction adds, g/2 (h^2 - h*^2), and the bed's slope inside the cell, then sum up to g h times the slope
// of the surface, which is zero to the last bit where the water is level.

#include <concepts>
#include <cstddef>

namespace wade::fluid::shallow_water {

// Cells, one after the other; `normal` to the faces and `along` them are the velocities.
struct Cells {
    const double *h, *eta, *normal, *along;
    [[nodiscard]] Cells from(std::size_t i) const { return {h + i, eta + i, normal + i, along + i}; }
};
// Cells to be written, or what each quantity rises from the centre of a cell to its upper face.
struct CellRow {
    double *h, *eta, *normal, *along;
    [[nodiscard]] operator Cells() const { return {h, eta, normal, along}; }  // NOLINT(google-explicit-constructor)
    [[nodiscard]] CellRow from(std::integral auto i) const { return {h + i, eta + i, normal + i, along + i}; }
};

// What passes through the faces per width and second: mass / density in m^2/s, momentum / density in m^3/s^2.
struct FluxRow {
    double *mass, *along;
    double *into_lower, *into_upper;  // normal momentum, without g h*^2/2 of the lower and of the upper side
    [[nodiscard]] FluxRow from(std::size_t i) const { return {mass + i, along + i, into_lower + i, into_upper + i}; }
};

struct FluxConstants {
    double gravity = 9.81;    // across the bed, m/s^2
    double dry = 1e-5;        // largest depth of a dry cell, m
    bool films_rest = false;  // whether nothing flows between two cells that are dry
};

}  // namespace wade::fluid::shallow_water
