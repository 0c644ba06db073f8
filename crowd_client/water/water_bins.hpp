#pragma once
// The water near the agents, sorted into the 2 x 2 m cells of the ground.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "crowd_client/equations.hpp"
#include "crowd_client/markers/ground_grid.hpp"
#include "crowd_client/water/water_view.hpp"

namespace wade::crowd {

// Particles of the cells that are within one cell of an active agent, ordered by cell and, within it, as they came.
// The arrays keep their memory from step to step.
struct WaterBins {
    GroundGrid grid;
    double period = 0;                      // World::period(), m; above 0 the border holds images of the water
    std::vector<double> x, z;               // m
    std::vector<float> mass;                // kg
    std::vector<float> vx, vz;              // stored units per second, see scale_x
    double scale_x = 1, scale_z = 1;        // m per stored unit, negative for a mirrored axis
    Vector2d column = Vector2d::Zero();     // width of the columns along x and z, m; 0: the particles are points
    bool with_heights = false;              // whether y and vy are filled, too
    std::vector<double> y, vy;              // m, m/s
    std::vector<std::uint32_t> cell_start;  // particles of cell c: [cell_start[c], cell_start[c + 1])

    // By cell, and one more for all that is outside: whether its water is kept; in the cells of agents it is summed up.
    enum Use : std::uint8_t { unused, kept, summed };
    std::vector<Use> use;
    std::vector<Contact> sums;                            // by cell; only `summed` cells are filled
    std::vector<std::uint32_t> kept_particle, kept_cell;  // working memory, as they came
    std::vector<std::uint32_t> order;                     // the kept particles of the frame, ordered by cell

    [[nodiscard]] bool has_columns() const { return column.x() > 0; }
    [[nodiscard]] WaterParticle particle(std::size_t k) const {
        return {static_cast<double>(mass[k]),
                {scale_x * static_cast<double>(vx[k]), scale_z * static_cast<double>(vz[k])}};
    }
};

// Bins over the ground of the scene, without water.
[[nodiscard]] WaterBins empty_bins(const Scene& scene);

// Sorts the particles that can matter to agents at `positions`; one pass over all particles, one over those kept.
// Particles outside the grid or with a NaN position are left out.
void bin_water(WaterBins& bins, const WaterView& water, std::span<const Vector2d> positions);

// The same for agents anywhere in the grid.
void bin_all_water(WaterBins& bins, const WaterView& water);

// Returns the total mass and momentum of the particles of a cell, added in their order.
[[nodiscard]] Contact sum_of_cell(const WaterBins& bins, std::size_t cell);

}  // namespace wade::crowd
