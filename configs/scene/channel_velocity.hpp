#pragma once
// v_F as a scene states it, at any time.

#include "configs/scene/scene.hpp"

namespace wade {

// channel.velocity, or channel.velocity_history if that has points: straight between them, constant before the first and
// after the last, m/s. At a jump, two points of one time, it is the velocity of the later point. t >= 0, s.
[[nodiscard]] double channel_velocity(const Channel& channel, double t);

}  // namespace wade
