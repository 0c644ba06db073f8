#pragma once
// Makes a crowd and takes its steps.

#include <optional>
#include <string_view>
#include <vector>

#include "configs/scene/fluid.hpp"
#include "crowd_client/crowd_state.hpp"

namespace wade::crowd {

// Sets up markers, agents and walls. Throws ConfigurationError for what the crowd cannot work with.
[[nodiscard]] CrowdWorld make_crowd(const Scene& scene);

// Properties of a stream's water that a scene may leave open.
struct StreamWater {
    std::optional<ModelKind> model;      // of a producer of this project
    double spacing = 0;                  // of particles, m, 0: not known
    Vector2d column = Vector2d::Zero();  // width of columns along x and z, m, 0: points
};

// Fits the sampling of the water, and the force on it, to this stream. Model and spacing matter where the scene leaves
// the model open. Call it before the first step. Throws ConfigurationError for a spacing that is too wide for people.
void suit_to_stream(CrowdWorld& crowd, const StreamWater& water);

// Takes the next step through the current water: Eq. 1-9 once, whatever the rate of the water's frames.
// The new state of each agent is computed from the frozen old state of all, so the order of the agents does not matter.
void step(CrowdWorld& crowd, const WaterView& water);

// Takes the same step, to the bit, through water already sorted, perhaps for several crowds: the bins hold at least the
// water within a cell of each active agent.
void step_through(CrowdWorld& crowd, const WaterBins& water);

// Returns the names of the stages of a step, in the order of StepTimes.
[[nodiscard]] std::vector<std::string_view> stage_names();

}  // namespace wade::crowd
