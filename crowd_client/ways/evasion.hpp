#pragma once
// Agents that step back from the front of the water: flee and evasion of Reynolds (1999), steering_behaviours.hpp.
//
// An agent looks at the particles within the radius. Their mean place and velocity are what it flees from: now (flee), or
// where that will be after T = distance / desired speed, at most the prediction (evasion). Eq. 3 then has the direction away from
// there in place of the goal's, so that agents still share the markers with the others. Where the mean of the directions to
// the particles is short there is water all round, and no front.

#include <cstdint>
#include <span>

#include "configs/scene/crowd.hpp"
#include "crowd_client/agents.hpp"
#include "crowd_client/water/water_bins.hpp"

namespace wade::crowd {

// Below this length of the mean direction the water is all round; on one side of a straight front it is 2 / pi.
inline constexpr double surrounded = 0.3;

// Replaces the goal offsets, m, of those of the active agents at `positions` that see a front; the bins hold the water within
// a cell of them.
void evade(const EvasionSettings& settings, const Agents& agents, std::span<const std::uint32_t> active,
           std::span<const Vector2d> positions, const WaterBins& water, std::span<Vector2d> goal_offsets);

}  // namespace wade::crowd
