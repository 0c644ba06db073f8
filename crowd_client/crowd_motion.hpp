#pragma once
// From velocities to places.

#include "crowd_client/crowd_world.hpp"

namespace wade::crowd {

[[nodiscard]] inline bool has_bodies(const CrowdWorld& crowd) {
    return crowd.bodies.rule != BodyRule::none;
}

[[nodiscard]] inline bool is_continuous(const CrowdWorld& crowd) {
    return crowd.scene.coupling.rule == CouplingRule::continuous;
}

// How many threads walk the crowd. One that is small takes less time than threads to wake up.
[[nodiscard]] int threads_for(const CrowdWorld& crowd);

// Moves the active agents by velocity * dt, or by what walls, the ends of the world and, if they have bodies, the others
// leave of it.
void move_agents(CrowdWorld& crowd);

}  // namespace wade::crowd
