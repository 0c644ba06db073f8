#pragma once
// Applies values from the command line to a merged scene document.

#include <nlohmann/json_fwd.hpp>

#include "configs/loading/scene_loader.hpp"

namespace wade {

// Sets one value; its pointer must exist in the schema, missing objects on the way are made. In an array the index may
// be that of an element or, to append, the number of elements.
void apply_override(nlohmann::json& document, const SceneOverride& change);

}  // namespace wade
