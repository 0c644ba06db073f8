#pragma once
// A small channel with water like that around the people, for the pilot. See pilot.hpp for its shapes.

#include <string>
#include <vector>

#include "fluid_server/model_choice/candidates.hpp"
#include "fluid_server/model_choice/scout.hpp"

namespace wade::fluid::model_choice {

// The patch: a channel with banks at z = 1 and z = 1 + width.
struct Patch {
    double depth = 0, velocity = 0, length = 0, width = 0;
    std::string channel, obstacles;  // JSON
    std::vector<Probe> probes;
};

// Returns the patch for a kind of water of this depth, m, and velocity, m/s. `spacing`: the coarser of the spacings
// that will run it, m.
[[nodiscard]] Patch patch_for(const Scene& scene, WaterKind kind, double depth, double velocity, double spacing);

// The patch as the candidate computes it, over `time` s. Throws ConfigurationError if it cannot be.
[[nodiscard]] Scene patch_scene(const Patch& patch, const Scene& scene, const Candidate& candidate, double time);

}  // namespace wade::fluid::model_choice
