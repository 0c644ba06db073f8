#pragma once
// From velocities to places.

#include <cstddef>
#include <string>

#include "crowd_client/crowd_state.hpp"

namespace wade::crowd {

// Moves the active agents by next.mean * dt, or by what walls, the ends of the world and, if they have bodies, the others
// leave of it.
void move_agents(CrowdWorld& crowd);

// Whether the water carries agent k out: into an outlet of a site or, as that is emptied, half a cell or spacing beside it [A].
// Who answers by the body has lost the feet then; who has a tau has gone farther with the water in this step than he walks.
[[nodiscard]] bool leaves_with_water(const CrowdWorld& crowd, std::size_t k);

// People who leave their houses, or go to the upper floor, when their time has come (markers/placed_houses.hpp), and who come to a shelter;
// departures.cpp.

// Of the people before their first step, with steps of dt, s.
[[nodiscard]] Indoors indoors_of(const Agents& agents, double dt);

// Lets out those whose time has come before the next step, as far as there is room before their doors, in the order in which they came to
// them. Costs nothing but for them, and looks at who is outside only while somebody waits. Asked again before the same step it does nothing.
void let_out(CrowdWorld& crowd);

// Whether somebody in a house may still come out.
[[nodiscard]] bool may_come_out(const CrowdWorld& crowd);

// Records the depth at the doors of people in houses, of the cells of the site's routes, at each update of the routes.
void note_depth_at_doors(CrowdWorld& crowd);

// Returns the number of people indoors, not upstairs, with more than deep_at_door of water at their door so far.
inline constexpr double deep_at_door = 0.5;  // m
[[nodiscard]] std::size_t count_behind_deep_water(const CrowdWorld& crowd);

// Returns a sentence on them; "" where there is none.
[[nodiscard]] std::string warning_of_deep_water(const CrowdWorld& crowd);

[[nodiscard]] bool goes_to_shelters(const CrowdWorld& crowd, std::uint32_t id);

// Takes somebody in who is on its feet at a shelter that has room, and says what has become of it.
[[nodiscard]] Outcome come_to_shelter(CrowdWorld& crowd, std::uint32_t id);

}  // namespace wade::crowd
