#pragma once
// Leads people through gates. The crowd's model knows goals only, no ways round corners; the tests of RiMEA ask for
// people who know the way, so the way is given from outside, as the gates of a route.

#include <vector>

#include "crowd_client/crowd_world.hpp"

namespace wade::validation {

// A line across the way from a to b, m, passed in the direction `forward` (a unit vector). People aim at the nearest point
// of it that is `inset` away from its ends.
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

// Everybody at the first gate of the route of its number.
Guide make_guide(const crowd::CrowdWorld& crowd, std::vector<Route> routes, std::vector<std::size_t> route_of);

// Notes which gates were passed and sets the goals for the next step. Who has passed the last one stands on its goal and
// is taken out by the crowd as arrived.
void guide(crowd::CrowdWorld& crowd, Guide& guide);

// Times at which gate number `gate` was passed, ascending, s.
std::vector<double> passages(const Guide& guide, std::size_t gate);

}  // namespace wade::validation
