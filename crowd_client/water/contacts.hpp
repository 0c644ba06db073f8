#pragma once
// Contact of an agent with the water around it.

#include <array>
#include <cstddef>
#include <vector>

#include "configs/numbers/kernel_area.hpp"
#include "crowd_client/equations.hpp"
#include "crowd_client/water/water_bins.hpp"

namespace wade::crowd {

// Depth and speed of the water in one cell.
struct CellWater {
    double depth = 0;  // areal mass of the cell / rest density, m; a cell that the bank cuts counts as a whole
    double speed = 0;  // |sum m v| / sum m, m/s
};

// Returns the largest distance of a particle that touches an agent, m: |r_a - r_p| (`difference`, as the authors'
// program does) or r_a + r_p (`sum`, as their text says).
[[nodiscard]] double contact_distance(const Coupling& coupling);

// Returns the fraction of a column within `distance` of the point that column_seen_from() refers to.
[[nodiscard]] double share_in_disc(const WaterBins& bins, const Rectangle& column, double distance);

// Computes Eq. 5 over the particles closer than `distance` in the ground plane, in the 3 x 3 cells around the agent; a
// column counts with its part that is closer. Needs distance <= 2 m less half a column's width. `touching` is working
// memory.
[[nodiscard]] Contact find_contact(const WaterBins& bins, const Vector2d& agent, double distance,
                                   std::vector<WaterParticle>& touching);

// Means over the particles of find_contact(); each particle counts once, whatever its mass.
struct TouchingMean {
    std::size_t count = 0;             // of the particles; all else is 0 if this is
    double height = 0;                 // y, m
    std::array<double, 3> velocity{};  // x, y, z, m/s
};

// Computes these means as find_contact() does; needs bins with heights.
[[nodiscard]] TouchingMean mean_of_touching(const WaterBins& bins, const Vector2d& agent, double distance);

// Returns the water in the agent's own cell, or in the column where the agent stands.
[[nodiscard]] CellWater water_at(const WaterBins& bins, const Vector2d& agent, double rest_density);

}  // namespace wade::crowd
