#pragma once
// What dam breaks over dry and wet beds share: columns compared with an exact solution.

#include <functional>

#include "fluid_server/fluid_world.hpp"
#include "profiles.hpp"
#include "run.hpp"
#include "shallow_water_exact.hpp"

namespace wade::validation {

// s: distance downstream of the dam, m; t: s
using ExactFlow = std::function<FlowState(double s, double t)>;

struct DamBreakErrors {
    double depth = 0;       // worst L1 of the frames compared, of H
    double speed = 0;       // the same of sqrt(g H)
    double last_depth = 0;  // of the last frame
};

struct DamBreak {
    const Scene& scene;
    double dam_x = 0;  // m; the water runs towards -x
    double depth = 0;  // H, of the reservoir, m
    ExactFlow exact;
};

// Throws ConfigurationError, naming the duration that is needed, if the scene ends before its first frame with
// t sqrt(g/H) >= first, so that nothing would be compared.
void check_duration(const DamBreak& dam, double first);

// Calls on_frame(t, scaled time, columns) for each frame between t sqrt(g/H) = 4 and 8.
using OnFrame = std::function<void(double t, double scaled, const Columns& columns)>;

// Advances the water by a frame of the scene and returns its particles.
using NextFrame = std::function<const fluid::Particles&()>;

// Runs the scene to its end. Depth and mean velocity of columns H/5 long are compared where the exact depth at their
// centre is above 0.15 H; this length is the same at every spacing, so that errors of several spacings are comparable.
DamBreakErrors run_dam_break(const DamBreak& dam, const NextFrame& next_frame, Curve& last, const OnFrame& on_frame);

}  // namespace wade::validation
