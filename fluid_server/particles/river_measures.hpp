#pragma once
// Measures of the whole river, for diagnostics.

#include <vector>

#include "configs/scene/scene.hpp"
#include "fluid_server/particles/bed_profile.hpp"
#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

// Of all fluid particles; those still inside the emitter do not count. Depth and speed are
// shm::Diagnostics::not_given if there is none.
struct RiverMeasures {
    double mean_depth = 0;        // m, twice the mean height of the mass above the bed
    double mean_speed = 0;        // m/s, towards -x
    double kinetic_energy = 0;    // J
    double potential_energy = 0;  // J, above y = 0
};

RiverMeasures measure_river(const Particles& particles, double particle_mass, double gravity,
                            const std::vector<BedFacet>& bed = {});

}  // namespace wade::fluid
