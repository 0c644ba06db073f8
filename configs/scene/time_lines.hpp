#pragma once
// Values that a scene gives as points in time.

#include <algorithm>
#include <iterator>
#include <vector>

#include "configs/scene/channel.hpp"
#include "configs/scene/scene.hpp"

namespace wade {

// Straight between the points, constant before the first and after the last. At a jump, two points of one time, it is the value
// of the later point. There is at least one; t >= 0, s.
template <typename Point>
[[nodiscard]] double value_at(const std::vector<Point>& points, double Point::*value, double t) {
    const auto after =
        std::upper_bound(points.begin(), points.end(), t, [](double time, const Point& p) { return time < p.time; });
    if (after == points.begin()) return points.front().*value;
    if (after == points.end()) return points.back().*value;
    const Point &a = *std::prev(after), &b = *after;
    return a.*value + (b.*value - a.*value) * ((t - a.time) / (b.time - a.time));
}

// v_F as a scene states it: channel.velocity, or channel.velocity_history if that has points, m/s.
[[nodiscard]] inline double channel_velocity(const Channel& channel, double t) {
    const std::vector<VelocityPoint>& history = channel.velocity_history;
    return history.empty() ? channel.velocity : value_at(history, &VelocityPoint::velocity, t);
}

template <typename Point>
[[nodiscard]] std::vector<double> times_of(const std::vector<Point>& points) {
    std::vector<double> times;
    times.reserve(points.size());
    for (const Point& point : points) times.push_back(point.time);
    return times;
}

}  // namespace wade
