#pragma once
// From velocities to places.

#include "crowd_client/crowd_state.hpp"

namespace wade::crowd {

// Moves the active agents by next.mean * dt, or by what walls, the ends of the world and, if they have bodies, the others
// leave of it.
void move_agents(CrowdWorld& crowd);

}  // namespace wade::crowd
