#pragma once
// Depth and speed of the water at each agent: the largest values of single steps, the means, and the mean tau.

#include <cstdint>
#include <span>

#include "crowd_client/agents.hpp"
#include "crowd_client/water/water_bins.hpp"

namespace wade::crowd {

// Adds one step to the records of the agents. positions[k] belongs to active[k].
//
// Depth and speed are the values of the agent's 2 x 2 m cell (water_at()). A single step holds few particles, so that
// the largest value is above the depth of the stream, and a cell that a bank cuts has too small a value. The means
// avoid both: they count the steps with the agent in the channel and water in its cell, and take the depth over the
// cell's part in the channel. An obstacle in the cell counts as ground. With columns all values are those of the
// agent's own column.
void note_water_met(Agents& agents, const Scene& scene, std::span<const std::uint32_t> active,
                    std::span<const Vector2d> positions, const WaterBins& water);

// Returns the mean depth over the steps with water at the agent, m; 0 if there were none.
[[nodiscard]] double mean_depth_met(const Agents& agents, std::size_t id);

// Returns the mean of depth times speed over the same steps, m2/s.
[[nodiscard]] double mean_dv_met(const Agents& agents, std::size_t id);

// Returns the mean of tau over the same steps, [0, 1]; 0 if there were none.
[[nodiscard]] double mean_tau_met(const Agents& agents, std::size_t id);

// Returns the fraction of the 2 x 2 m cell of a position that is in the channel, (0, 1]; 0 if the position itself is
// not.
[[nodiscard]] double channel_share(const Channel& channel, const Vector2d& place);

}  // namespace wade::crowd
