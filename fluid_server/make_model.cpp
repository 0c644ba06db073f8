#include "fluid_server/make_model.hpp"

#include "configs/errors/exit_code.hpp"
#include "fluid_server/dfsph/dfsph_model.hpp"
#include "fluid_server/kinematic/kinematic_stream.hpp"
#include "fluid_server/mixed/model.hpp"
#include "fluid_server/shallow_water/model.hpp"
#include "fluid_server/steering/steering_model.hpp"

namespace wade::fluid {

std::unique_ptr<FluidModel> make_fluid_model(const Scene& scene) {
    if (scene.fluid.model == wade::ModelKind::kinematic) {
        return std::make_unique<KinematicStream>(scene);
    }
    if (scene.fluid.model == wade::ModelKind::shallow_water) {
        return std::make_unique<shallow_water::ShallowWaterModel>(scene);
    }
    if (scene.fluid.model == wade::ModelKind::mixed) {
        return std::make_unique<mixed::MixedModel>(scene);
    }
    if (scene.fluid.model == wade::ModelKind::steering) {
        return std::make_unique<SteeringModel>(scene);
    }
    if (scene.fluid.model == wade::ModelKind::automatic) {
        throw ConfigurationError(scene.name +
                                 ": /fluid/model: \"auto\" stands for a model that fluid_server chooses first; allowed "
                                 "here: dfsph, kinematic, shallow_water and steering.");
    }
    return std::make_unique<DfsphModel>(scene);
}

}  // namespace wade::fluid
