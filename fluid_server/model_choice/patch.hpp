#pragma once
// A small channel of water like that which people meet, for the pilot. See pilot.hpp for its shapes.

#include <string>
#include <vector>

#include "fluid_server/model_choice/candidates.hpp"
#include "fluid_server/model_choice/scout.hpp"

namespace wade::fluid::model_choice {

// The patch: a channel whose banks are z = 1 and z = 1 + width.
struct Patch {
    double depth = 0, velocity = 0, length = 0, width = 0;
    std::string channel, obstacles;  // JSON
    std::vector<Probe> probes;
};

// For a kind of water of this depth, m, and velocity, m/s. `spacing`: the coarser one of those that will run it, m.
[[nodiscard]] Patch patch_for(const Scene& scene, WaterKind kind, double depth, double velocity, double spacing);

// The patch as the candidate computes it, over `time` s. Throws ConfigurationError if it cannot be.
[[nodiscard]] Scene patch_scene(const Patch& patch, const Scene& scene, const Candidate& candidate, double time);

}  // namespace wade::fluid::model_choice
