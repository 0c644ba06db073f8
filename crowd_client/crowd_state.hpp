#pragma once
// The state of a crowd, and the data of its current step.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "configs/scene/crowd.hpp"
#include "configs/scene/interval.hpp"
#include "crowd_client/agents.hpp"
#include "crowd_client/bodies/bodies.hpp"
#include "crowd_client/markers/biocrowds.hpp"
#include "crowd_client/navigation/navigation.hpp"
#include "crowd_client/navigation/obstacles.hpp"
#include "crowd_client/navigation/site_routes.hpp"
#include "crowd_client/people/links.hpp"
#include "crowd_client/people/pose.hpp"
#include "crowd_client/pushing.hpp"
#include "crowd_client/responses/response.hpp"
#include "crowd_client/step_times.hpp"
#include "crowd_client/water/ragdoll.hpp"
#include "crowd_client/water/sampling_density.hpp"
#include "crowd_client/water/water_bins.hpp"

namespace wade::crowd {

// Agents in houses, and their departures (departures.cpp).
struct Departure {
    std::uint64_t step = 0;  // the agent leaves before this step
    std::uint32_t id = 0;
};
struct Indoors {
    std::vector<Departure> due;          // by step, then id
    std::size_t next = 0;                // index of the next departure in `due`
    std::vector<std::uint32_t> at_door;  // past their departure time, until there is room before their door
    std::size_t inside = 0, upstairs = 0;
    std::uint64_t let_out_before = 0;  // the step that let_out() last ran for
};

struct CrowdWorld {
    Scene scene;
    double dt = 0;            // length of a step, s
    std::uint64_t steps = 0;  // taken so far; step k leads to the state at time k dt
    BodyClock clock;          // without bodies people decide in each step
    double part_time = 0;     // length of the current part of a step, s

    Agents agents;
    std::vector<std::uint32_t> active;  // ids of the agents outdoors with the outcome `active`, ascending
    std::size_t arrived = 0;
    std::size_t dead = 0;
    std::size_t sheltered = 0;
    Indoors indoors;
    std::uint64_t last_arrival_step = 0;  // 0: no agent has arrived
    std::size_t events_applied = 0;       // number of scene.events applied; make_crowd sorts them by frame
    std::vector<std::string> warnings;    // sentences for the user, in order of time
    std::uint8_t holds_told = 0;          // one bit for each StandingReason (standing.hpp) that was warned of

    Markers markers;
    Walls walls;
    Navigation navigation;                   // empty if agents walk straight to their goals
    std::vector<Link> links;                 // between agents, to ropes and lines, in the order of their creation
    std::vector<double> hands_spent;         // end of the rest of the hands after a rope, s, by id; empty without ropes
    Rescues rescues;                         // empty without rescuers
    std::optional<Feeling> feeling;          // water sampling; none with the response paper, one way, without poses
    std::optional<Pushing> pushing;          // impulses between agents and water; two-way runs only
    std::optional<SamplingDensity> density;  // check of another producer's points, until it is decided
    std::shared_ptr<const Response> response;  // to the water; has no state, so that copies of a crowd share it
    int threads = 1;  // largest number of threads of a step; the results are the same for any number

    // Data of the current step; index k belongs to active[k]. They are members so that their memory is reused.
    WaterBins water;  // unused if the water is sorted for several crowds
    MarkerMemory marker_memory;
    Bodies bodies;                       // empty without bodies
    Motion motion;                       // Eq. 1-3
    std::vector<Vector2d> goal_offsets;  // m; with navigation, along the route
    std::vector<Vector2d> positions;     // at the start of the step, m
    std::vector<Contact> contacts;       // Eq. 5; 0 for agents that respond by body
    std::vector<FeltWater> felt;         // empty without `feeling`
    std::vector<Vector2d> walking;       // v_B, m/s
    NextVelocities next;                 // of the response, v^{t+1}, m/s
    std::vector<Vector2d> wishes;        // with bodies: next.mean * dt, m
    std::vector<Interval> ends;          // with bodies: range of x that the world allows each, m
    std::vector<WaterParticle> touching;
    Shelters shelters;
    std::vector<Ragdoll> ragdolls;   // empty if the scene has no condition for them
    std::vector<Tumbling> tumbling;  // by id; empty without ragdolls
    std::vector<Pose> poses;         // by id; empty if the scene asks for none

    std::shared_ptr<StepTimes> times;  // wall time of each stage; null: not measured
};

// Returns the time at the end of the last step, s.
[[nodiscard]] inline double time_of(const CrowdWorld& crowd) {
    return static_cast<double>(crowd.steps) * crowd.dt;
}

[[nodiscard]] inline bool has_bodies(const CrowdWorld& crowd) {
    return crowd.bodies.rule != BodyRule::none;
}

// Returns true if the step needs water beyond the cells round the agents' positions at its start: agents move in
// several parts, rescuers look at distant water, or the routes of a site are due.
[[nodiscard]] inline bool needs_all_water(const CrowdWorld& crowd) {
    return crowd.clock.parts > 1 || !crowd.rescues.rescuers.empty() ||
           are_site_routes_due(crowd.navigation, crowd.steps + 1);
}

// Returns the number of threads of a step: 1 for a small crowd, as its step takes less time than waking threads.
[[nodiscard]] inline int threads_for(const CrowdWorld& crowd) {
    constexpr std::size_t worth_it = 1000;
    return crowd.active.size() < worth_it ? 1 : crowd.threads;
}

}  // namespace wade::crowd
