#pragma once
// Response of people to the water: the velocity of each in the next step, from a frozen state of all.
//
//   walking velocities, contacts, water  --respond-->  velocities  --walls, bodies-->  positions

#include <cstdint>
#include <span>
#include <vector>

#include "crowd_client/agents.hpp"
#include "crowd_client/water/felt_water.hpp"
#include "crowd_client/water/water_bins.hpp"

namespace wade::crowd {

// Input of a response. Index k of the lists belongs to the agent active[k].
struct FrozenCrowd {
    const Scene& scene;
    double dt;                              // length of the step, s
    const Agents& agents;                   // as the step before left them
    std::span<const std::uint32_t> active;  // ids, ascending
    std::span<const Vector2d> positions;    // m
    std::span<const Vector2d> walking;      // v_B of Eq. 4, m/s
    std::span<const Contact> contacts;      // Eq. 5
    const WaterBins& water;                 // the water within a cell of each agent
    std::span<const FeltWater> felt;        // flow sampled at each agent; empty if not needed
};

// Result of a response, by index.
struct NextVelocities {
    std::vector<Vector2d> mean;  // over the step: mean * dt is the displacement without walls and bodies, m/s
    std::vector<Vector2d>
        at_end;                  // v(t + dt) of agents that keep a velocity from step to step, Agents::momentary, m/s;
                                 // empty if they do not
    std::vector<Vector2d> push;  // impulse of the water on agents that respond by their body, N s; else meaningless
};

// Called once a step for all agents, so that the cost of the call is negligible. A response keeps no memory. The same
// state leads to the same velocities, and these do not depend on the order of the agents. With tau = 0 or without water
// the velocity is, or tends to, the walking velocity. Agents holds what must last from step to step.
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
