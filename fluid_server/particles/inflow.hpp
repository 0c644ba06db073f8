#pragma once
// v_F in time: channel.velocity, or channel.velocity_history if that has points. All in m/s, at times t >= 0 in s.

#include "configs/scene/scene.hpp"

namespace wade::fluid {

// v_F at time t: straight between the points, constant before the first and after the last. At a jump, two points of one
// time, it is the velocity of the later point.
[[nodiscard]] double velocity_at(const Channel& channel, double t);

// Mean of v_F from t0 to t1, exactly: what an inflow delivers in a step is this times the length of the step, so that its
// sum over any steps is the integral of v_F. That at t0 if t1 is not later.
[[nodiscard]] double mean_velocity(const Channel& channel, double t0, double t1);

// Return the largest v_F from t0 to t1, and at any time; the latter is not below channel.velocity, the initial velocity
// of a filled river.
[[nodiscard]] double largest_velocity(const Channel& channel, double t0, double t1);
[[nodiscard]] double largest_velocity(const Channel& channel);

}  // namespace wade::fluid
