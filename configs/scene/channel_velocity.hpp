#pragma once
// v_F as a scene states it, at any time.

#include <algorithm>
#include <iterator>

#include "configs/scene/scene.hpp"

namespace wade {

// channel.velocity, or channel.velocity_history if that has points: straight between them, constant before the first and
// after the last, m/s. At a jump, two points of one time, it is the velocity of the later point. t >= 0, s.
[[nodiscard]] inline double channel_velocity(const Channel& channel, double t) {
    const std::vector<VelocityPoint>& history = channel.velocity_history;
    if (history.empty()) return channel.velocity;
    const auto after = std::upper_bound(history.begin(), history.end(), t,
                                        [](double time, const VelocityPoint& point) { return time < point.time; });
    if (after == history.begin()) return history.front().velocity;
    if (after == history.end()) return history.back().velocity;
    const VelocityPoint &a = *std::prev(after), &b = *after;
    return a.velocity + (b.velocity - a.velocity) * ((t - a.time) / (b.time - a.time));
}

}  // namespace wade
