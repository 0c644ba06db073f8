#pragma once
// Who holds whom and what: chains of the scene (hand_in_hand of a group); whoever is taken hold of when the water carries him past
// (/crowd/helping); ropes (/crowd/ropes); lines of rescuers (rescue.hpp). People have two hands. Forces and when a link lets go:
// people/links.hpp.
//
// A rope is held by whom the water carries past it and by who walks along it, within 0.8 m, with both hands. A carried body clasps
// one place; who stands moves its hands along as it walks, so that the rope pulls across alone, and lets go of what it walks away from.

// Neighbours of a chain of whom one is nearer to the goal at the start, by half a link or more, walk in file while both are firm on
// their feet: the one behind goes where the other is, v_w = max(0, v_leader . e + (L - 0.7 m) / 1.6 s), e the direction to him. All of a
// file walk at the mean of their speeds [A]: in front nobody has a lee, and those behind cannot pass. Without hands people walk by
// markers, which lead them round one another.

#include "crowd_client/crowd_state.hpp"

namespace wade::crowd {

// Of groups that walk hand in hand: neighbours on the start grid.
[[nodiscard]] std::vector<Link> links_of_scene(const Scene& scene, const Agents& agents);

// Corrects the velocities in crowd.next of those who hold one another, in a step of crowd.part_time; takes hold of who is carried
// within reach and of ropes, lets go of whom no hand holds any more, and of those who have arrived or died.
void hold_hands(CrowdWorld& crowd);

// Gives all of a file the mean of their desired speeds.
void share_speeds_of_files(CrowdWorld& crowd);

// Turns crowd.walking of those who walk in file to whom they follow.
void walk_in_files(CrowdWorld& crowd);

[[nodiscard]] Link link_between(const People& people, std::uint32_t a, std::uint32_t b, bool pushes);

// From somebody to a place, in a periodic world the shorter way, m.
[[nodiscard]] Vector2d way_to(const CrowdWorld& crowd, std::uint32_t id, const Vector2d& place);

// How many hands of each hold something, by id.
[[nodiscard]] std::vector<std::uint8_t> hands_in_use(const CrowdWorld& crowd);

}  // namespace wade::crowd
