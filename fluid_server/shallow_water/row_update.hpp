#pragma once
// One Euler step of a band of rows.

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

}  // namespace wade::fluid::shallow_water
