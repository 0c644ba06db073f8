#include "configs/scene/channel_velocity.hpp"

#include <algorithm>
#include <iterator>

namespace wade {

double channel_velocity(const Channel& channel, double t) {
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
