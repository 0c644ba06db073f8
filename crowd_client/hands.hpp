#pragma once
// Links between agents, and from agents to ropes and lines. A person has two hands. Forces and release:
// people/links.hpp.
//
//   chains   of the scene (hand_in_hand of a group)
//   helping  an agent on its feet takes hold of an agent that drifts past or is pinned (/crowd/helping)
//   ropes    of the scene (/crowd/ropes): agents in water within 0.8 m, drifting or walking, hold them with both hands
//   lines    of rescuers (rescue.hpp)
//
// An agent without ground clasps one point of a rope. An agent with ground moves its hands along the rope as it walks,
// so that the rope pulls only across. It lets go of a rope that it walks away from.
//
// Linked neighbours of a chain walk in file while both are firm on their feet, if one of them starts nearer to its goal
// by half a link or more. The follower walks towards its leader, v_w = max(0, v_leader . e + (L - 0.7 m) / 1.6 s), e
// the direction to the leader. All agents of a file walk at the mean of their speeds [A]: the first has no wake
// shielding, and followers cannot pass. Other agents walk by markers, which lead them round one another.

#include "crowd_client/crowd_state.hpp"

namespace wade::crowd {

// Returns the links between neighbours on the start grid, for groups that walk hand in hand.
[[nodiscard]] std::vector<Link> links_of_scene(const Scene& scene, const Agents& agents);

// Creates links to drifting agents and ropes within reach, and corrects the velocities in crowd.next of linked agents
// for a step of crowd.part_time. Removes links that let go (people/links.hpp) and links of agents that have arrived or
// died.
void hold_hands(CrowdWorld& crowd);

// Sets the desired speed of all agents of a file to its mean.
void share_speeds_of_files(CrowdWorld& crowd);

// Turns crowd.walking of followers in a file towards their leaders.
void walk_in_files(CrowdWorld& crowd);

// Returns a link between two agents with the weaker of their grips.
[[nodiscard]] Link link_between(const People& people, std::uint32_t a, std::uint32_t b, bool pushes);

// Returns the displacement from an agent to a position, m; in a periodic world the shorter one.
[[nodiscard]] Vector2d way_to(const CrowdWorld& crowd, std::uint32_t id, const Vector2d& place);

// Returns the number of hands in use of each agent, by id.
[[nodiscard]] std::vector<std::uint8_t> hands_in_use(const CrowdWorld& crowd);

}  // namespace wade::crowd
