#pragma once
// One function a family of cases.

#include "stability_case.hpp"

namespace wade::stability {

std::vector<Case> water_cases();     // still water, jets, sheets
std::vector<Case> sloshing_cases();  // waves in a tank
std::vector<Case> inflow_cases();    // emitter, outlet, recirculation
std::vector<Case> particle_cases();  // none, one, two in one place, long runs
std::vector<Case> likeness_cases();  // the same flow in another scale, or cut into other frames
std::vector<Case> crowd_cases();     // people in and out of the water

}  // namespace wade::stability
