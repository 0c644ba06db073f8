#pragma once
// Cases that run with other models of the water than DFSPH.

#include <initializer_list>

#include "fluid_server/steering/steering_world.hpp"
#include "run.hpp"

namespace wade::validation {

// Throws ConfigurationError if the scene's model is not one of those that the case can be run with.
void refuse_other_models(const Scene& scene, std::initializer_list<FluidModel> allowed);

// One frame of the scene.
void advance_frame(fluid::steering::SteeringWorld& world, Cost& cost);

// Writes model, cost and number of particles into the result.
void note_cost(const Cost& cost, const fluid::steering::SteeringWorld& world, Result& result);

}  // namespace wade::validation
