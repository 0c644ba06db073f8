#pragma once
// Resolutions of the water of a scene at which the outcome of its people depends on them.

#include <string>
#include <vector>

#include "configs/scene/scene.hpp"

namespace wade::crowd {

// Who chose the model of the water: the scene, or fluid_server for a scene of model `auto`.
enum class ModelChoice { of_scene, of_server };

// Sentences for the user, each with the key and with the values that remedy it together: layers of particles, time steps, cells
// of a site. They hold for water of this project's models; a producer of another program resolves its water by itself.
[[nodiscard]] std::vector<std::string> water_warnings(const Scene& scene, ModelChoice choice = ModelChoice::of_scene);

}  // namespace wade::crowd
