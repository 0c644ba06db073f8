#pragma once
// A uniform river: it holds its mass, its depth and its speed, everywhere where agents walk.

#include "validation_case.hpp"

namespace wade::validation {

// Runs the scene, a channel that is periodic along x and filled at t = 0, and compares it with a depth (that of the scene)
// and a mean velocity. Means are those of the last quarter of the run, at most of 100 s.
//
//   mass         of the water a square metre, against the depth, over its exact value
//   depth        twice the mean height of the water, over that of the scene
//   speed        mean velocity towards -x over the exact one
//   worst_speed  the frame that is farthest from it (of the whole run)
//   worst_tile   the tile of 10 m x 3 m whose mean speed is farthest from it
//   depth_drift, speed_drift   change a minute of the straight line through the second half of the run, over the exact one
Result run_river(const Scene& scene, double exact_velocity);

}  // namespace wade::validation
