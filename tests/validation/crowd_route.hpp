#pragma once
// Leads people through gates. The crowd's model alone has goals and no routes round corners, but the tests of RiMEA
// need people with known routes. So each route is given from outside, as a list of gates.

#include <functional>
#include <vector>

#include "configs/scene/interval.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_run.hpp"

namespace wade::validation {

// A line across a route, from a to b, m, passed in the direction `forward` (a unit vector). People aim at the nearest
// point of it that is `inset` away from its ends.
struct Gate {
    crowd::Vector2d a, b;
    crowd::Vector2d forward;
    double inset = 0.2;
};

using Route = std::vector<Gate>;

struct Guide {
    std::vector<Route> routes;
    std::vector<std::size_t> route_of;           // by agent
    std::vector<std::size_t> next_gate;          // by agent
    std::vector<std::vector<double>> passed_at;  // by agent and gate, s; only gates passed are listed
};

// Returns a guide with each agent before the first gate of its route; `route_of` gives the route by agent.
Guide make_guide(const crowd::CrowdWorld& crowd, std::vector<Route> routes, std::vector<std::size_t> route_of);

// Records passed gates and sets the goals for the next step. An agent past its last gate stands on its goal, and the
// crowd removes it as arrived.
void guide(crowd::CrowdWorld& crowd, Guide& guide);

// Returns the times when gate number `gate` was passed, ascending, s.
std::vector<double> passages(const Guide& guide, std::size_t gate);

// The corridor without ends: 20 m long and 8 m wide between walls.

// Walkable ground between the walls of crowd_ring_corridor.json, m.
inline constexpr Interval corridor_z{1, 9};
inline constexpr Interval four_metres{3, 7};

// Weidmann's speed at a density (1/m2), m/s: v = 1.34 (1 - exp(-1.913 (1/rho - 1/5.4))). U. Weidmann, Transporttechnik
// der Fussgaenger, ETH Zuerich 1993.
double weidmann_speed(double density);

// The corridor with people of 1.34 m/s spread over a jittered grid, at `density` per m2 of walkable ground (rounded to
// whole people). With `two_ways` every second person walks towards -x. across: between the walls, m.
crowd::CrowdWorld corridor_crowd(const Request& request, SpeedRule rule, double density, bool two_ways,
                                 const Interval& across = corridor_z);

// Takes steps for `time` seconds and returns the mean progress in the wanted direction, m/s; notes overlaps in each
// tenth step. after_step: called after each one.
double mean_progress(crowd::CrowdWorld& crowd, double time, Result& result, Overlaps& overlaps,
                     const std::function<void()>& after_step = {});

}  // namespace wade::validation
