#pragma once
// Particles near a position.

#include <algorithm>
#include <array>
#include <cstddef>

#include "configs/numbers/kernel_area.hpp"
#include "crowd_client/water/water_bins.hpp"

namespace wade::crowd {

// Particles tested at a time, and room for the close ones with what a vector store writes beyond them.
inline constexpr std::size_t chunk_size = 256;
using Chunk = std::array<std::size_t, chunk_size + 8>;

// Writes the particles of [begin, end), at most chunk_size, that are closer to the agent than the root of `limit` into
// `close`, in their order; returns their number. Closeness is hard to predict, so that there is no branch: each
// particle is written, and overwritten by the next one unless it is close.
std::size_t find_close(const WaterBins& bins, const Vector2d& agent, double limit, std::size_t begin, std::size_t end,
                       Chunk& close);

// Returns the distance of a coordinate outside [lo, hi], m; 0 inside.
[[nodiscard]] inline double gap_to_interval(double v, double lo, double hi) {
    const double beyond = std::max(lo - v, v - hi);
    return beyond > 0 ? beyond : 0;
}

// Calls visit(k) for each particle k of the bins that is closer than `distance` in the ground plane and at most 2 m away along
// each axis.
template <typename Visit>
void for_each_particle_near(const WaterBins& bins, const Vector2d& agent, double distance, Visit&& visit) {
    const int column = GroundGrid::line_of(agent.x());
    const int row = GroundGrid::line_of(agent.y());
    const double limit = distance * distance;
    for (int r = row - 1; r <= row + 1; ++r) {
        const double gap_z = gap_to_interval(agent.y(), GroundGrid::line_start(r), GroundGrid::line_start(r + 1));
        // Cells of a row lie behind one another in the arrays; cells out of reach are left out.
        const auto in_reach = [&](int c) {
            const double gap_x = gap_to_interval(agent.x(), GroundGrid::line_start(c), GroundGrid::line_start(c + 1));
            return gap_x * gap_x + gap_z * gap_z < limit;
        };
        if (!in_reach(column)) continue;
        const std::size_t first = bins.grid.index(in_reach(column - 1) ? column - 1 : column, r);
        const std::size_t last = bins.grid.index(in_reach(column + 1) ? column + 1 : column, r);
        const std::size_t end = bins.cell_start[last + 1];
        for (std::size_t begin = bins.cell_start[first]; begin < end; begin += chunk_size) {
            Chunk close;
            const std::size_t count = find_close(bins, agent, limit, begin, std::min(end, begin + chunk_size), close);
            for (std::size_t c = 0; c < count; ++c) visit(close[c]);
        }
    }
}

// Returns the rectangle of column k relative to a position, in units of `radius`, that of a kernel around it, m.
[[nodiscard]] inline Rectangle column_seen_from(const WaterBins& bins, std::size_t k, const Vector2d& position,
                                                double radius) {
    const Vector2d half = 0.5 * bins.column / radius;
    const double x = (bins.x[k] - position.x()) / radius, z = (bins.z[k] - position.y()) / radius;
    return {x - half.x(), x + half.x(), z - half.y(), z + half.y()};
}

// Calls visit(k) for each column that may reach into the circle of this radius, m, round a position. The radius and half the width
// of a column are at most 2 m together.
template <typename Visit>
void for_each_column_near(const WaterBins& bins, const Vector2d& position, double radius, Visit&& visit) {
    const Vector2d reach = Vector2d::Constant(radius) + 0.5 * bins.column;
    for_each_particle_near(bins, position, reach.norm(), visit);
}

}  // namespace wade::crowd
