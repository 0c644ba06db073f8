#pragma once
// The agents: one array per property; the index is the agent's id.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "configs/scene/scene.hpp"
#include "crowd_client/equations.hpp"
#include "crowd_client/people/people.hpp"

namespace wade::crowd {

// indoors: in a house that the agent may still leave. upper_floor: on the upper floor of a house, for good.
enum class Outcome : std::uint8_t {
    active,
#define WADE_OUTCOME(word, kind, end) word,
#include "configs/scene/states.def"
};

// Returns "active", "arrived" and so on, as written to agents.csv.
[[nodiscard]] std::string_view outcome_name(Outcome outcome);

// Smallest fraction of a body's radius, with shoulders turned (bodies/bodies.hpp).
inline constexpr double turned_share = 0.72;

// State of agents with bodies from step to step, by id; empty without bodies. Symbols as in bodies/bodies.hpp.
struct BodyMemory {
    std::vector<double> radius;        // r_i, m
    std::vector<double> contested;     // kappa, [0, 1]
    std::vector<double> blocked;       // b, [0, 1]
    std::vector<double> followed;      // lambda, [0, 1]
    std::vector<double> follow_speed;  // F, [0, 1]
    std::vector<double> opposed;       // o, [0, 1]
    std::vector<double> pressed;       // c, [0, 1]
    std::vector<double> stood;         // s, [0, 10] s
    std::vector<double> detour_side;   // 1: to the right, -1: to the left
    std::vector<double> trapped_time;  // how long b has been above 0.9, s
    std::vector<Vector2d> intended;    // v_B of the last decision, m/s
    std::vector<Vector2d> pace;        // v, m/s
    std::vector<Vector2d> went;        // displacement since the last decision, m
    std::vector<Vector2d> wished;      // wished displacement since then, m
    std::vector<std::uint64_t> draw;   // stream of random numbers, from the start position
};

// tau of an agent over time; agents of a group may share the points.
struct TauLine {
    std::uint32_t id = 0;
    std::shared_ptr<const std::vector<TauPoint>> points;
};

struct Agents {
    std::vector<Vector2d> position;     // m
    std::vector<std::int32_t> laps;     // periods passed towards +x in a periodic world; 0 in an open one
    std::vector<Vector2d> velocity;     // displacement of the last step / dt, m/s
    std::vector<Vector2d> momentary;    // v(t) at the end of the last step, m/s; unused unless agents keep a velocity
    std::vector<Vector2d> heading;      // unit vector of the last motion; towards the goal before the first
    std::vector<Vector2d> goal;         // m; x is unwrapped in a periodic world
    std::vector<double> desired_speed;  // s_max, m/s; in water, for agents that respond by body, the speed there
    std::vector<double> mass;           // m_a, kg
    std::vector<double> tau;            // susceptibility, [0, 1]; by body: max(0, 1 - 1 / S) of the last step
    std::vector<std::uint32_t> group;   // index into Crowd::groups
    std::vector<Outcome> outcome;
    std::vector<Vector2d> start;           // position at t = 0, m
    std::vector<std::uint64_t> end_step;   // step of arrival or death; meaningless while active
    std::vector<double> end_before;        // time from the arrival or death to the end of that step, s
    std::vector<double> path_length;       // m
    std::vector<double> max_depth;         // deepest water met, m
    std::vector<double> max_dv;            // largest depth times speed of the water met, m2/s
    std::vector<std::uint64_t> wet_steps;  // number of steps in water (water_met.hpp)
    std::vector<double> depth_sum;         // of the water over these steps, m
    std::vector<double> dv_sum;            // of depth times speed over these steps, m2/s
    std::vector<double> tau_sum;           // of tau at the start of each of these steps

    std::vector<std::uint64_t> lost_feet_step;  // first step toppled, afloat or swept away; 0: none so far

    std::vector<Vector2d> stay;                            // position at `stay_step`, not left since (standing.hpp), m
    std::vector<std::uint64_t> stay_step, stay_wet_steps;  // the step, and wet_steps then
    std::vector<bool> standing;

    std::vector<std::int32_t> house;  // number of its house at the start, -1: outdoors; empty without a site
    std::vector<std::string>
        resident;  // id of the table of residents; empty without such ids, and may be shorter than the others
    std::vector<double> leaves;  // when it leaves its house, s; 0 outdoors, infinite: never; empty without a site
    std::vector<std::uint8_t> goes_up;  // 1: it leaves for the upper floor; empty without a site
    std::vector<double> door_depth;     // deepest water at the door while in the house, m; empty without a site

    std::vector<TauLine> tau_lines;  // of agents with a tau that changes in time

    BodyMemory body;
    People people;

    [[nodiscard]] std::size_t size() const { return position.size(); }
};

// Returns the displacement from an agent to its goal, m. period: World::period().
[[nodiscard]] inline Vector2d goal_offset(const Agents& agents, std::size_t id, double period) {
    Vector2d offset = agents.goal[id] - agents.position[id];
    offset.x() -= agents.laps[id] * period;
    return offset;
}

// Returns all agents on their start grids, ids counted through the groups in order, row by row within a group.
// Random properties (tau, mass, the deviation of the start) depend on the seed, the agent's id and the purpose
// alone; only a start within a millimetre of another one, or in an obstacle, is drawn again.
// Throws ConfigurationError for a position of the grid outside the world, and for starts that have no room.
[[nodiscard]] Agents make_agents(const Scene& scene);

}  // namespace wade::crowd
