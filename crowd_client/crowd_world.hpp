#pragma once
// The crowd and all it needs to take a step.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "crowd_client/agents.hpp"
#include "crowd_client/bodies/bodies.hpp"
#include "crowd_client/markers/biocrowds.hpp"
#include "crowd_client/water/ragdoll.hpp"
#include "crowd_client/water/water_bins.hpp"
#include "crowd_client/ways/navigation.hpp"
#include "crowd_client/ways/obstacles.hpp"

namespace wade::crowd {

struct CrowdWorld {
    Scene scene;
    double dt = 0;            // length of a step, s
    std::uint64_t steps = 0;  // taken; step k leads to the state at time k dt

    Agents agents;
    std::vector<std::uint32_t> active;  // ids of the agents that are neither arrived nor dead, ascending
    std::size_t arrived = 0;
    std::size_t dead = 0;
    std::uint64_t last_arrival_step = 0;  // 0 = nobody has arrived
    std::size_t events_applied = 0;       // of scene.events, which make_crowd sorts by frame

    Markers markers;
    Walls walls;
    Navigation navigation;  // empty where people go straight
    int threads = 1;        // at most that many walk the crowd; the results are the same for any number

    // Of the step at hand; place k belongs to active[k]. Kept for their memory.
    WaterBins water;  // unused where the water is sorted for several crowds
    MarkerMemory marker_memory;
    Bodies bodies;                       // empty where people have none
    Motion motion;                       // Eq. 1-3
    std::vector<Vector2d> goal_offsets;  // m; with navigation along the way
    std::vector<Vector2d> positions;     // frozen at the beginning of the step
    std::vector<Contact> contacts;       // Eq. 5
    std::vector<Vector2d> walking;       // v_B, m/s
    std::vector<Vector2d> velocity;      // v^{t+1}, m/s; with the rule `continuous` its mean over the step
    std::vector<Vector2d> wishes;        // with bodies: velocity * dt, m
    std::vector<bool> may_fall;          // with bodies: over the edge at x = 0
    std::vector<WaterParticle> touching;
    std::vector<Ragdoll> ragdolls;  // empty where the scene has no condition for them
};

// Sets up markers, agents and walls. Throws ConfigurationError for what the crowd cannot work with.
[[nodiscard]] CrowdWorld make_crowd(const Scene& scene);

// Takes the next step, through the water as it is: Eq. 1-9 once, whatever the rate of the water's frames.
// The new state of each agent is computed from the frozen old state of all, so the order of the agents does not matter.
void step(CrowdWorld& crowd, const WaterView& water);

// The same step, to the bit, through water that was sorted before, perhaps for several crowds: the bins hold at least the
// water within a cell of each active agent.
void step_through(CrowdWorld& crowd, const WaterBins& water);

}  // namespace wade::crowd
