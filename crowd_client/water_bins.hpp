#pragma once
// The water near the agents, sorted into the 2 x 2 m cells of the ground, and what an agent feels of it.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "crowd_client/equations.hpp"
#include "crowd_client/ground_grid.hpp"
#include "crowd_client/water_view.hpp"

namespace wade::crowd {

// Particles of the cells that are within one cell of an active agent, ordered by cell and, within it, as they came.
// The arrays keep their memory from step to step.
struct WaterBins {
    GroundGrid grid;
    double period = 0;                      // World::period(), m; above 0 the border holds images of the water
    std::vector<double> x, z;               // m
    std::vector<double> mass;               // kg
    std::vector<double> vx, vz;             // m/s
    std::vector<std::uint32_t> cell_start;  // particles of cell c: [cell_start[c], cell_start[c + 1])

    std::vector<std::uint8_t> near_agent;  // by cell
    std::vector<std::uint32_t> kept_particle, kept_cell;
};

// Depth and speed of the water in one cell.
struct CellWater {
    double depth = 0;  // areal mass of the cell / rest density, m; a cell that the bank cuts counts as a whole
    double speed = 0;  // |sum m v| / sum m, m/s
};

// Bins over the ground of the scene, without water.
[[nodiscard]] WaterBins empty_bins(const Scene& scene);

// Sorts the particles that can matter to agents at `positions`; one pass over all particles, one over those kept.
// Particles outside the grid and such with a NaN position are left out.
void bin_water(WaterBins& bins, const WaterView& water, std::span<const Vector2d> positions);

// The same for agents anywhere in the grid.
void bin_all_water(WaterBins& bins, const WaterView& water);

// Distance within which a particle touches an agent: |r_a - r_p| (`difference`, as the authors' program does) or
// r_a + r_p (`sum`, as their text says), m.
[[nodiscard]] double contact_distance(const Coupling& coupling);

// Eq. 5 over the particles closer than `distance` in the ground plane, of the 3 x 3 cells round the agent.
// Needs distance <= 2 m. `touching` is working memory.
[[nodiscard]] Contact find_contact(const WaterBins& bins, const Vector2d& agent, double distance,
                                   std::vector<WaterParticle>& touching);

// The water in the agent's own cell.
[[nodiscard]] CellWater water_at(const WaterBins& bins, const Vector2d& agent, double rest_density);

}  // namespace wade::crowd
