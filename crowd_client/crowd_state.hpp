#pragma once
// The crowd and all it needs to take a step.

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
#include "crowd_client/people/links.hpp"
#include "crowd_client/people/pose.hpp"
#include "crowd_client/pushing.hpp"
#include "crowd_client/responses/response.hpp"
#include "crowd_client/step_times.hpp"
#include "crowd_client/water/ragdoll.hpp"
#include "crowd_client/water/sampling_density.hpp"
#include "crowd_client/water/water_bins.hpp"
#include "crowd_client/ways/navigation.hpp"
#include "crowd_client/ways/obstacles.hpp"
#include "crowd_client/ways/site_ways.hpp"

namespace wade::crowd {

// Those in houses (departures.hpp).
struct Departure {
    std::uint64_t step = 0;  // before which it leaves
    std::uint32_t id = 0;
};
struct Indoors {
    std::vector<Departure> due;          // by step, then id
    std::size_t next = 0;                // of those
    std::vector<std::uint32_t> at_door;  // whose time has come, until there is room before their door
    std::size_t inside = 0, upstairs = 0;
    std::uint64_t let_out_before = 0;  // the step for which this was done
};

struct CrowdWorld {
    Scene scene;
    double dt = 0;            // length of a step, s
    std::uint64_t steps = 0;  // taken; step k leads to the state at time k dt
    BodyClock clock;          // without bodies people decide in each step
    double part_time = 0;     // length of the part of a step at hand, s

    Agents agents;
    std::vector<std::uint32_t> active;  // ids of the agents that are outdoors on their way, ascending
    std::size_t arrived = 0;
    std::size_t dead = 0;
    std::size_t sheltered = 0;
    Indoors indoors;
    std::uint64_t last_arrival_step = 0;  // 0 = nobody has arrived
    std::size_t events_applied = 0;       // of scene.events, which make_crowd sorts by frame
    std::vector<std::string> warnings;    // sentences for the user, in the order in which they came up
    std::uint8_t holds_told = 0;          // bit of each hold (standing.hpp) of which a warning was given

    Markers markers;
    Walls walls;
    Navigation navigation;            // empty where people go straight
    std::vector<Link> links;          // of those who hold one another, in the order in which they took hold
    std::vector<double> hands_spent;  // time until which hands rest, s, by id; empty without ropes
    Rescues rescues;                  // empty without rescuers
    std::optional<Feeling> feeling;   // of who feels the water; none with the response paper, one way, without poses
    std::optional<Pushing> pushing;   // of people who push the water
    std::optional<SamplingDensity> density;    // of points that another producer publishes, until it is decided
    std::shared_ptr<const Response> response;  // to the water; has no state, so that copies of a crowd share it
    int threads = 1;  // at most that many walk the crowd; the results are the same for any number

    // Of the step at hand; place k belongs to active[k]. Kept for their memory.
    WaterBins water;  // unused where the water is sorted for several crowds
    MarkerMemory marker_memory;
    Bodies bodies;                       // empty where people have none
    Motion motion;                       // Eq. 1-3
    std::vector<Vector2d> goal_offsets;  // m; with navigation along the way
    std::vector<Vector2d> positions;     // frozen at the beginning of the step
    std::vector<Contact> contacts;       // Eq. 5, of who answers by tau
    std::vector<FeltWater> felt;         // empty where nobody feels the water
    std::vector<Vector2d> walking;       // v_B, m/s
    NextVelocities next;                 // of the response, v^{t+1}, m/s
    std::vector<Vector2d> wishes;        // with bodies: next.mean * dt, m
    std::vector<Interval> ends;          // with bodies: of the world along x, for each, m
    std::vector<WaterParticle> touching;
    Shelters shelters;
    std::vector<Ragdoll> ragdolls;   // empty where the scene has no condition for them
    std::vector<Tumbling> tumbling;  // by id; empty without ragdolls
    std::vector<Pose> poses;         // by id; empty where the scene asks for none

    std::shared_ptr<StepTimes> times;  // if somebody wants to know how long the stages take
};

// Time at the end of the last step, s.
[[nodiscard]] inline double time_of(const CrowdWorld& crowd) {
    return static_cast<double>(crowd.steps) * crowd.dt;
}

[[nodiscard]] inline bool has_bodies(const CrowdWorld& crowd) {
    return crowd.bodies.rule != BodyRule::none;
}

// Whether people get further in a step than the water round where they stood reaches, or look at water farther away, as who looks for
// ways in a site does.
[[nodiscard]] inline bool needs_all_water(const CrowdWorld& crowd) {
    return crowd.clock.parts > 1 || !crowd.rescues.rescuers.empty() ||
           are_site_ways_due(crowd.navigation, crowd.steps + 1);
}

// How many threads walk the crowd. One that is small takes less time than threads to wake up.
[[nodiscard]] inline int threads_for(const CrowdWorld& crowd) {
    constexpr std::size_t worth_it = 1000;
    return crowd.active.size() < worth_it ? 1 : crowd.threads;
}

}  // namespace wade::crowd
