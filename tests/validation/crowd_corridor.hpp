#pragma once
// The corridor without ends: 20 m long and 8 m wide between walls.

#include <functional>

#include "crowd_run.hpp"

namespace wade::validation {

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
