#include "fluid_server/particles/inflow.hpp"

#include <algorithm>

#include "configs/scene/channel.hpp"
#include "configs/scene/time_lines.hpp"

namespace wade::fluid {

namespace {

// The first point after t.
auto point_after(const std::vector<VelocityPoint>& history, double t) {
    return std::upper_bound(history.begin(), history.end(), t,
                            [](double time, const VelocityPoint& point) { return time < point.time; });
}

double on_line(double t, const VelocityPoint& a, const VelocityPoint& b) {
    return a.velocity + (b.velocity - a.velocity) * ((t - a.time) / (b.time - a.time));
}

}  // namespace

double velocity_at(const Channel& channel, double t) {
    return channel_velocity(channel, t);
}

double mean_velocity(const Channel& channel, double t0, double t1) {
    const std::vector<VelocityPoint>& history = channel.velocity_history;
    VelocityPoint last{t0, velocity_at(channel, t0)};
    if (history.empty() || t1 <= t0) {
        return last.velocity;
    }
    double way = 0;
    auto next = point_after(history, t0);
    for (; next != history.end() && next->time < t1; ++next) {
        way += 0.5 * (last.velocity + next->velocity) * (next->time - last.time);
        last = *next;
    }
    // Before the first point `last` has its velocity, so that the line to it is level.
    const double end = next == history.end() ? last.velocity : on_line(t1, last, *next);
    way += 0.5 * (last.velocity + end) * (t1 - last.time);
    return way / (t1 - t0);
}

double largest_velocity(const Channel& channel, double t0, double t1) {
    double largest = std::max(velocity_at(channel, t0), velocity_at(channel, t1));
    for (const VelocityPoint& point : channel.velocity_history) {
        if (t0 <= point.time && point.time <= t1) {
            largest = std::max(largest, point.velocity);
        }
    }
    return largest;
}

double largest_velocity(const Channel& channel) {
    double largest = channel.velocity;
    for (const VelocityPoint& point : channel.velocity_history) {
        largest = std::max(largest, point.velocity);
    }
    return largest;
}

}  // namespace wade::fluid
