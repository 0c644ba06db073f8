#pragma once
// Who holds whom: chains of the scene (hand_in_hand of a group), and whoever is taken hold of when the water carries him past
// (/crowd/helping). People have two hands. Forces and when a link lets go: people/links.hpp.

#include "crowd_client/crowd_state.hpp"

namespace wade::crowd {

// Of groups that walk hand in hand: neighbours on the start grid.
[[nodiscard]] std::vector<Link> links_of_scene(const Scene& scene, const Agents& agents);

// Corrects the velocities in crowd.next of those who hold one another, in a step of crowd.part_time; takes hold of who is carried
// within reach, lets go of whom no hand holds any more, and of those who have arrived or died.
void hold_hands(CrowdWorld& crowd);

}  // namespace wade::crowd
