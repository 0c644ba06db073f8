#pragma once
// What the people of a crowd feel of the water behind others, and what they do to it.

#include <span>
#include <vector>

#include "crowd_client/agents.hpp"
#include "crowd_client/bodies/body_cells.hpp"
#include "crowd_client/people/push.hpp"
#include "crowd_client/water/felt_water.hpp"

namespace wade::crowd {

// Of a crowd that pushes the water (/coupling/two_way), by id.
struct Pushing {
    std::vector<Vector2d> given;    // impulse that the water gave each since the start, and thus lost, N s
    std::vector<double> submerged;  // min(h, H) where it was last in the water, m
    std::vector<bool> wet;          // it is in the water
};
// Gives people the W_e and C of a usual stream.
[[nodiscard]] Pushing start_pushing(const Scene& scene, const Feeling& feeling, Agents& agents);

// Gives those in the water the W_e and C of the stream there, before others' wakes are taken from it.
void note_discs(const Scene& scene, const Feeling& feeling, std::span<const std::uint32_t> active,
                std::span<const FeltWater> felt, Agents& agents);

// Who makes wakes: everybody in the water. Place k of all lists is the same person.
struct WakeMakers {
    std::span<const Vector2d> positions;  // m
    std::span<const Vector2d> stream;     // U at each, m/s
    std::span<const double> drag_width;   // C_D B, m; 0: makes none
    std::span<const double> width;        // B, m
};

// The share of the velocity that the deepest wake takes from each, [0, 1].
void find_wakes(const World& world, const WakeMakers& makers, BodyCells& cells, std::vector<double>& deficit);

// Wakes of people before people (/coupling/shelter); place k of the lists is that of FeltWater.
struct Shelters {
    std::vector<double> deficit;  // of the velocity, [0, 1]
    std::vector<double> lee;      // the same of the velocity of the water past them as they walk
    BodyCells cells;
    std::vector<Vector2d> stream, passing;
    std::vector<double> drag_width, width;
};

// Slows what people feel who stand in wakes of others, and finds the wakes in which they walk: in still water, too, who walks
// in a file has them before him.
void shelter(const Scene& scene, const Agents& agents, std::span<const std::uint32_t> active,
             std::span<const Vector2d> positions, Shelters& shelters, std::vector<FeltWater>& felt);

// The impulses of a step of dt, s: `worked_out` of who answers by its body, by place, else the drag on people who go at
// Agents::velocity.
void push_water(const Scene& scene, const Agents& agents, std::span<const std::uint32_t> active,
                std::span<const FeltWater> felt, std::span<const Vector2d> worked_out, double dt, Pushing& pushing);

}  // namespace wade::crowd
