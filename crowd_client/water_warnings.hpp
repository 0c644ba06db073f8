#pragma once
// Warns of a water resolution so coarse that the outcome of the agents depends on it.

#include <string>
#include <vector>

#include "configs/scene/scene.hpp"

namespace wade::crowd {

// Origin of the water model: the scene, or fluid_server for a scene of model `auto`.
enum class ModelChoice { of_scene, of_server };

// Returns sentences for the user, each with the key and with the values that together remedy it: layers of particles,
// time steps, cells of a site. They hold for this project's water models; another program's producer resolves its water
// by itself.
[[nodiscard]] std::vector<std::string> water_warnings(const Scene& scene, ModelChoice choice = ModelChoice::of_scene);

}  // namespace wade::crowd
