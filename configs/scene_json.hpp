#pragma once
// From a complete JSON document to the typed scene.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "configs/scene.hpp"

namespace wade {

// Writes out what stands for something else: the crowd's tau, mass and speed into the groups that set none, count, and
// an event's time as a frame. `document` has all defaults, `as_written` none yet; `source` is named in errors.
void resolve_shorthands(nlohmann::json& document, const nlohmann::json& as_written, const std::string& source);

// Reads a document that resolve_shorthands has left. The hash is not set.
[[nodiscard]] Scene scene_from_json(const nlohmann::json& document);

}  // namespace wade
