#pragma once
// From a complete JSON document to the typed scene.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "configs/scene/scene.hpp"

namespace wade {

// Writes out what stands for something else: the crowd's tau, mass and speed into the groups that set none, count, and
// an event's time as a frame. `document` has all defaults; `must_be_used` names those of the crowd's that are refused if
// every group has its own; `source` is named in errors.
void resolve_shorthands(nlohmann::json& document, const std::vector<std::string>& must_be_used,
                        const std::string& source);

// tau, mass_kg and desired_speed_m_s: what the crowd gives to the groups that have none.
[[nodiscard]] const std::vector<std::string>& inherited_by_groups();

// Reads a document that resolve_shorthands has left. The hash is not set.
[[nodiscard]] Scene scene_from_json(const nlohmann::json& document);

}  // namespace wade
