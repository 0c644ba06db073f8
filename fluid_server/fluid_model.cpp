#include "fluid_server/fluid_model.hpp"

#include "fluid_server/dfsph_model.hpp"
#include "fluid_server/kinematic_stream.hpp"

namespace wade::fluid {

std::unique_ptr<FluidModel> make_fluid_model(const Scene& scene) {
    if (scene.fluid.model == wade::FluidModel::kinematic) {
        return std::make_unique<KinematicStream>(scene);
    }
    return std::make_unique<DfsphModel>(scene);
}

}  // namespace wade::fluid
