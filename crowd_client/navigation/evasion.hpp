#pragma once
// Agents step back from the front of the water: flee and evasion of Reynolds (1999), steering_behaviours.hpp.
//
// An agent perceives the particles within the radius. It flees from their mean position (flee). With evasion it flees
// from that position moved at their mean velocity for T = distance / desired speed, at most the prediction. Eq. 3 then
// uses the direction away from there instead of the goal's, so that agents still share the markers with the others. If
// the mean of the directions to the particles is short, water lies all around, and there is no front.

#include <cstdint>
#include <span>

#include "configs/scene/crowd.hpp"
#include "crowd_client/agents.hpp"
#include "crowd_client/water/water_bins.hpp"

namespace wade::crowd {

// Below this length of the mean direction the water is all around; on one side of a straight front it is 2 / pi.
inline constexpr double surrounded = 0.3;

// Replaces the goal offsets, m, of active agents at `positions` that perceive a front. The bins hold the water within a
// cell of the agents.
void evade(const EvasionSettings& settings, const Agents& agents, std::span<const std::uint32_t> active,
           std::span<const Vector2d> positions, const WaterBins& water, std::span<Vector2d> goal_offsets);

}  // namespace wade::crowd
