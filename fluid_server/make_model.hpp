#pragma once
// The models of the water: one row each.

#include <memory>
#include <span>

#include "configs/scene/fluid.hpp"
#include "fluid_server/estimate.hpp"
#include "fluid_server/fluid_model.hpp"

namespace wade::fluid {

struct ModelRow {
    ModelKind kind;  // its word in scenes is name_of(kind) (configs/scene/choices.hpp)
    std::unique_ptr<FluidModel> (*make)(const Scene& scene);
    Estimate (*estimate)(const Scene& scene);
};

// In the order of documents. "auto" is none of them: it stands for one that is chosen first.
[[nodiscard]] std::span<const ModelRow> models_of_water();

// The row of the model that the scene names. Throws ConfigurationError if there is none.
[[nodiscard]] const ModelRow& model_row(const Scene& scene, std::span<const ModelRow> models = models_of_water());

// The model that the scene names, with its water at t = 0.
[[nodiscard]] std::unique_ptr<FluidModel> make_fluid_model(const Scene& scene,
                                                           std::span<const ModelRow> models = models_of_water());

// What its run will take; takes nothing itself.
[[nodiscard]] Estimate estimate(const Scene& scene, std::span<const ModelRow> models = models_of_water());

}  // namespace wade::fluid
