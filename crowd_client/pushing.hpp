#pragma once
// What the people of a crowd feel of the water behind others, and what they do to it.

#include <vector>

#include "crowd_client/agents.hpp"
#include "crowd_client/people/push.hpp"
#include "crowd_client/water/felt_water.hpp"

namespace wade::crowd {

// Of a crowd that pushes the water (/coupling/two_way), by id.
struct Pushing {
    std::vector<Vector2d> given;    // impulse that the water gave each since the start, and thus lost, N s
    std::vector<double> submerged;  // min(h, H) where it was last in the water, m
    std::vector<bool> wet;          // it is in the water
};
// Gives people the C of those who push.
[[nodiscard]] Pushing start_pushing(const Scene& scene, double spread, Agents& agents);

// Wakes of people before people (/coupling/shelter); place k of the lists is that of FeltWater.
struct Shelters {
    std::vector<double> deficit;  // of the velocity, [0, 1]
    WakeMemory memory;
    std::vector<Vector2d> stream;
    std::vector<double> drag_width, width;
};

// W_e of a scene's water, m: see people/push.hpp.
[[nodiscard]] double disc_width(const Scene& scene, double spread);

// Slows what people feel who stand in wakes of others.
void shelter(const Scene& scene, const Agents& agents, std::span<const std::uint32_t> active,
             std::span<const Vector2d> positions, Shelters& shelters, std::vector<FeltWater>& felt);

// The impulses of a step of dt, s: `worked_out` of who answers by its body, by place, else the drag on people who go at
// Agents::velocity.
void push_water(const Scene& scene, const Agents& agents, std::span<const std::uint32_t> active,
                std::span<const FeltWater> felt, std::span<const Vector2d> worked_out, double dt, Pushing& pushing);

}  // namespace wade::crowd
