#pragma once
// Proposes changes of the solver settings of a scene after its simulation became unstable.

#include <string>
#include <vector>

#include "configs/scene/scene.hpp"

namespace wade::fluid {

struct SettingChange {
    std::string pointer;  // JSON pointer of the scene
    std::string from, to;
};

// Every solver setting that is looser than its default goes to it; a divergence solve that
// is switched off stays off. If none is, fluid.cfl is halved.
[[nodiscard]] std::vector<SettingChange> stabler_settings(const Fluid& fluid);

// "change /fluid/cfl from 2 to 0.5 and /fluid/density_solve/max_iterations from 1 to 100"
[[nodiscard]] std::string advice(const Fluid& fluid);

// " --set /fluid/cfl=0.5 --set /fluid/density_solve/max_iterations=100"
[[nodiscard]] std::string options_of_advice(const Fluid& fluid);

}  // namespace wade::fluid
