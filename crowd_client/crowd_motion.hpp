#pragma once
// Moves agents by their velocities; departures from houses and arrival at shelters.

#include <cstddef>
#include <string>

#include "crowd_client/crowd_state.hpp"

namespace wade::crowd {

// Moves the active agents by next.mean * part_time, as far as walls, the ends of the world and, with bodies, other
// agents allow.
void move_agents(CrowdWorld& crowd);

// Returns true if the water carries agent k out of the site: into an outlet, or to within 1.5 cells or particle
// spacings of its line, as the outlet is emptied and may leave the agent half a cell or spacing beside it [A]. An agent
// that responds by body must have lost its feet and hold on to nothing. An agent with a given tau must have moved
// farther along the momentum of the water in this step than it walks.
[[nodiscard]] bool leaves_with_water(const CrowdWorld& crowd, std::size_t k);

// Departures and arrivals, in departures.cpp: residents leave their houses, or go to the upper floor, at their
// departure time (markers/placed_houses.hpp); agents arrive at shelters.

// Returns the agents in houses and their departures before the first step; dt: length of a step, s.
[[nodiscard]] Indoors indoors_of(const Agents& agents, double dt);

// Releases agents with a departure time before the next step, in order of arrival at the door, once there is room
// before it. The positions of agents outdoors are read only while an agent waits at its door. A second call before the
// same step does nothing.
void let_out(CrowdWorld& crowd);

// Returns true if an agent in a house may still come out.
[[nodiscard]] bool may_come_out(const CrowdWorld& crowd);

// Records the depth at the doors of agents in houses, from the cells of the site's routes, at each update of the
// routes.
void note_depth_at_doors(CrowdWorld& crowd);

// Returns the number of people indoors, not upstairs, with more than deep_at_door of water at their door so far.
inline constexpr double deep_at_door = 0.5;  // m
[[nodiscard]] std::size_t count_behind_deep_water(const CrowdWorld& crowd);

// Returns a warning with their number and the largest depth; "" if there are none.
[[nodiscard]] std::string warning_of_deep_water(const CrowdWorld& crowd);

// Returns true if the agent's group of a site goes to shelters.
[[nodiscard]] bool goes_to_shelters(const CrowdWorld& crowd, std::uint32_t id);

// Admits an agent with ground under it at a shelter with room. Returns its outcome: `active` if it was not admitted.
[[nodiscard]] Outcome come_to_shelter(CrowdWorld& crowd, std::uint32_t id);

}  // namespace wade::crowd
