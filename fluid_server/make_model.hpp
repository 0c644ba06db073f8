#pragma once
// From the name of a model in the scene to the model.

#include <memory>

#include "fluid_server/fluid_model.hpp"

namespace wade::fluid {

// The model that the scene names, with its water at t = 0.
[[nodiscard]] std::unique_ptr<FluidModel> make_fluid_model(const Scene& scene);

}  // namespace wade::fluid
