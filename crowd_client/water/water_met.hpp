#pragma once
// Depth and speed of the water in which each agent stood, the largest values of single steps and means, and its mean tau there.

#include <cstdint>
#include <span>

#include "crowd_client/agents.hpp"
#include "crowd_client/water/water_bins.hpp"

namespace wade::crowd {

// Takes one step into the records of the agents. positions[k] belongs to active[k].
//
// Both are those of the agent's 2 x 2 m cell (water_at()). A single step holds few particles, so that the largest value is
// above the depth of the stream, and a cell that a bank cuts reads less. The means are free of both: they count the steps
// in which the agent is in the channel and its cell holds water, and take the depth over the cell's part that is in the
// channel. An obstacle in the cell counts as ground. Of columns all are those of the column where the agent stands.
void note_water_met(Agents& agents, const Scene& scene, std::span<const std::uint32_t> active,
                    std::span<const Vector2d> positions, const WaterBins& water);

// Mean depth of the water over the steps in which the agent stood in it, m; 0 if it never did.
[[nodiscard]] double mean_depth_met(const Agents& agents, std::size_t id);

// Mean of depth times speed over the same steps, m2/s.
[[nodiscard]] double mean_dv_met(const Agents& agents, std::size_t id);

// Mean of tau over the same steps, [0, 1]; 0 if there were none.
[[nodiscard]] double mean_tau_met(const Agents& agents, std::size_t id);

// Share of the 2 x 2 m cell of a position that is in the channel, (0, 1]; 0 if the position itself is not.
[[nodiscard]] double channel_share(const Channel& channel, const Vector2d& place);

}  // namespace wade::crowd
