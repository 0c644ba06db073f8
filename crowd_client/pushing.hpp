#pragma once
// Wake shielding between agents, and the momentum exchange between agents and water.

#include <span>
#include <vector>

#include "crowd_client/agents.hpp"
#include "crowd_client/bodies/body_cells.hpp"
#include "crowd_client/people/push.hpp"
#include "crowd_client/water/felt_water.hpp"

namespace wade::crowd {

// Momentum exchange of a two-way run (/coupling/two_way), by id.
struct Pushing {
    std::vector<Vector2d> given;    // impulse from the water on the agent since the start, N s; the water lost it
    std::vector<double> submerged;  // min(h, H) when the agent was last in water, m
    std::vector<bool> wet;          // the agent is in water
};
// Sets W_e and C (people/push.hpp) of all agents for a stream of 1 m/s and 1 m.
[[nodiscard]] Pushing start_pushing(const Scene& scene, const Feeling& feeling, Agents& agents);

// Sets W_e and C of each agent in water for the sampled flow there, before wakes of other agents are subtracted.
void note_discs(const Scene& scene, const Feeling& feeling, std::span<const std::uint32_t> active,
                std::span<const FeltWater> felt, Agents& agents);

// All agents in water make wakes. Index k of all lists is the same agent.
struct WakeMakers {
    std::span<const Vector2d> positions;  // m
    std::span<const Vector2d> stream;     // U at each, m/s
    std::span<const double> drag_width;   // C_D B, m; 0: makes none
    std::span<const double> width;        // B, m
};

// Computes the fraction of the velocity that the deepest wake takes from each agent, [0, 1].
void find_wakes(const World& world, const WakeMakers& makers, BodyCells& cells, std::vector<double>& deficit);

// Wake shielding between agents (/coupling/shelter); index k of the lists is that of FeltWater.
struct Shelters {
    std::vector<double> deficit;  // of the velocity, [0, 1]
    std::vector<double> lee;      // the same for the flow relative to the moving agent
    BodyCells cells;
    std::vector<Vector2d> stream, passing;
    std::vector<double> drag_width, width;
};

// Reduces the sampled flow of agents in wakes of others, and finds the wakes of the relative flow that agents walk in.
// In still water, too, an agent in a file walks in the wakes of the agents before it.
void shelter(const Scene& scene, const Agents& agents, std::span<const std::uint32_t> active,
             std::span<const Vector2d> positions, Shelters& shelters, std::vector<FeltWater>& felt);

// Adds the impulses of a step of dt, s, to `pushing`: worked_out[k] for agents that respond by body, else the drag on
// an agent that moves at Agents::velocity.
void push_water(const Scene& scene, const Agents& agents, std::span<const std::uint32_t> active,
                std::span<const FeltWater> felt, std::span<const Vector2d> worked_out, double dt, Pushing& pushing);

}  // namespace wade::crowd
