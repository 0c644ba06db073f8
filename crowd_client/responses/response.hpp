#pragma once
// How people answer the water: the velocity of each in the next step, from a frozen state of all.
//
//   walking velocities, contacts, water  --respond-->  velocities  --walls, bodies-->  places

#include <cstdint>
#include <span>
#include <vector>

#include "crowd_client/agents.hpp"
#include "crowd_client/water/felt_water.hpp"
#include "crowd_client/water/water_bins.hpp"

namespace wade::crowd {

// What a response may look at. Place k of the lists belongs to the agent active[k].
struct FrozenCrowd {
    const Scene& scene;
    double dt;                              // length of the step, s
    const Agents& agents;                   // as the step before left them
    std::span<const std::uint32_t> active;  // ids, ascending
    std::span<const Vector2d> positions;    // m
    std::span<const Vector2d> walking;      // v_B of Eq. 4, m/s
    std::span<const Contact> contacts;      // Eq. 5
    const WaterBins& water;                 // what lies within a cell of each of them
    std::span<const FeltWater> felt;        // what each feels; empty where nobody asks for it
};

// What it answers, by place.
struct NextVelocities {
    std::vector<Vector2d> mean;  // over the step: what the agent goes, but for walls and bodies, is mean * dt, m/s
    std::vector<Vector2d>
        at_end;                  // v(t + dt) of agents that keep a velocity from step to step, Agents::momentary, m/s;
                                 // empty if they do not
    std::vector<Vector2d> push;  // impulse of the water on who answers by its body, N s; else meaningless
};

// Called once a step for all agents, so that what it costs beside the loop over them is nothing. It has no memory: the
// same state leads to the same velocities, an agent's depends on nobody's place in the list, and with tau = 0 or without
// water it is, or tends to, the walking velocity. What must last from step to step lies in Agents.
class Response {
 public:
    Response() = default;
    Response(const Response&) = delete;
    Response& operator=(const Response&) = delete;
    virtual ~Response() = default;

    // Fills `next`, whose lists are of any length and content before.
    virtual void respond(const FrozenCrowd& crowd, NextVelocities& next) const = 0;
};

}  // namespace wade::crowd
