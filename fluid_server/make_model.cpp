#include "fluid_server/make_model.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/choices.hpp"
#include "configs/scene/fluid.hpp"
#include "fluid_server/dfsph/dfsph_model.hpp"
#include "fluid_server/kinematic/kinematic_stream.hpp"
#include "fluid_server/mixed/model.hpp"
#include "fluid_server/shallow_water/model.hpp"
#include "fluid_server/steering/steering_model.hpp"

namespace wade::fluid {

namespace {

template <typename Model>
constexpr ModelRow row(ModelKind kind) {
    return {kind, [](const Scene& scene) -> std::unique_ptr<FluidModel> { return std::make_unique<Model>(scene); },
            &Model::estimate};
}

constexpr std::array models{row<DfsphModel>(ModelKind::dfsph), row<KinematicStream>(ModelKind::kinematic),
                            row<shallow_water::ShallowWaterModel>(ModelKind::shallow_water),
                            row<SteeringModel>(ModelKind::steering), row<mixed::MixedModel>(ModelKind::mixed)};

}  // namespace

std::span<const ModelRow> models_of_water() {
    return models;
}

const ModelRow& model_row(const Scene& scene, std::span<const ModelRow> rows) {
    const auto row =
        std::find_if(rows.begin(), rows.end(), [&](const ModelRow& r) { return r.kind == scene.fluid->model; });
    if (row != rows.end()) return *row;
    std::string names;
    for (const ModelRow& r : rows) names += (names.empty() ? "" : ", ") + name_of(r.kind);
    throw ConfigurationError(scene.name + ": /fluid/model: " + quoted(scene.fluid->model) +
                             " is no model by itself; allowed here: " + names);
}

std::unique_ptr<FluidModel> make_fluid_model(const Scene& scene, std::span<const ModelRow> rows) {
    return model_row(scene, rows).make(scene);
}

Estimate estimate(const Scene& scene, std::span<const ModelRow> rows) {
    return model_row(scene, rows).estimate(scene);
}

}  // namespace wade::fluid
