#pragma once
// Leads people through gates. The crowd's model knows goals only, no ways round corners; the tests of RiMEA ask for
// people who know the way, so the way is given from outside, as the gates of a route.

#include <functional>
#include <vector>

#include "configs/scene/interval.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_run.hpp"

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

// The corridor without ends: 20 m long and 8 m wide between walls.

// Walkable ground between the walls of crowd_ring_corridor.json, m.
inline constexpr Interval corridor_z{1, 9};
inline constexpr Interval four_metres{3, 7};

// Weidmann's speed at a density (1/m2), m/s: v = 1.34 (1 - exp(-1.913 (1/rho - 1/5.4))). U. Weidmann, Transporttechnik
// der Fussgaenger, ETH Zuerich 1993.
double weidmann_speed(double density);

// The corridor with people of 1.34 m/s spread over a jittered grid, at `density` per m2 of walkable ground (rounded to
// whole people). With `two_ways` every second one walks towards -x. across: between the walls, m.
crowd::CrowdWorld corridor_crowd(const Request& request, SpeedRule rule, double density, bool two_ways,
                                 const Interval& across = corridor_z);

// Takes steps for `time` seconds and returns the mean progress in the wanted direction, m/s; notes overlaps in each
// tenth step. after_step: called after each one.
double mean_progress(crowd::CrowdWorld& crowd, double time, Result& result, Overlaps& overlaps,
                     const std::function<void()>& after_step = {});

}  // namespace wade::validation
