#pragma once
// What an agent feels of the water round it.

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

// Distance within which a particle touches an agent: |r_a - r_p| (`difference`, as the authors' program does) or
// r_a + r_p (`sum`, as their text says), m.
[[nodiscard]] double contact_distance(const Coupling& coupling);

// Returns the fraction of a column that lies within `distance` of the point from which it is seen (column_seen_from).
[[nodiscard]] double share_in_disc(const WaterBins& bins, const Rectangle& column, double distance);

// Eq. 5 over the particles closer than `distance` in the ground plane, of the 3 x 3 cells round the agent; of a column over the part
// of it that is closer. Needs distance <= 2 m less half a column's width. `touching` is working memory.
[[nodiscard]] Contact find_contact(const WaterBins& bins, const Vector2d& agent, double distance,
                                   std::vector<WaterParticle>& touching);

// Means over the particles that find_contact takes; each particle counts once, whatever its mass.
struct TouchingMean {
    std::size_t count = 0;             // of the particles; the rest is 0 where this is
    double height = 0;                 // y, m
    std::array<double, 3> velocity{};  // x, y, z, m/s
};

// As find_contact; needs bins with heights.
[[nodiscard]] TouchingMean mean_of_touching(const WaterBins& bins, const Vector2d& agent, double distance);

// The water in the agent's own cell, or in the column where the agent stands.
[[nodiscard]] CellWater water_at(const WaterBins& bins, const Vector2d& agent, double rest_density);

}  // namespace wade::crowd
