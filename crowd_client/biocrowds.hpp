#pragma once
// BioCrowds: agents compete for the markers of the ground and walk towards the mean of those they own.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "crowd_client/equations.hpp"
#include "crowd_client/markers.hpp"

namespace wade::crowd {

// Which markers belong to whom; position k of the walker list owns offsets[start[k] .. start[k + 1]).
// The other arrays are working memory that is kept from step to step.
struct MarkerClaims {
    std::vector<std::uint32_t> start;
    std::vector<Vector2d> offsets;  // marker - walker, m

    std::vector<std::uint32_t> walker_cell_start, walkers_by_cell;
    std::vector<std::uint32_t> candidates;
    std::vector<std::uint32_t> claimed_marker, claimed_by;
    std::vector<double> weights;

    // In a periodic world the walkers and their images beyond the joint, and whose image each is.
    std::vector<Vector2d> with_images;
    std::vector<std::uint32_t> image_of;
};

// Gives each marker to the nearest walker within `perception_radius`, ties to the one that comes first in `walkers`.
// Walkers: positions of the active agents in the order of their ids, in the world; nobody else claims markers.
// period: World::period(); where it is above 0, walkers see the markers beyond the joint. Needs markers placed for it.
void claim_markers(MarkerClaims& claims, const Markers& markers, std::span<const Vector2d> walkers,
                   double perception_radius, double period = 0);

// The walking velocity of one walker by Eq. 1-4, m/s; zero without markers.
//   k            place in the list given to claim_markers
//   goal_offset  goal - position, m
[[nodiscard]] Vector2d biocrowds_velocity(MarkerClaims& claims, std::size_t k, const Vector2d& goal_offset,
                                          double desired_speed, SpeedRule rule, double dt);

}  // namespace wade::crowd
