#pragma once
// From JSON to the members that a list of fields names, and back.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "configs/scene/keys.hpp"

namespace wade {

// Sets the members of `list` from a merged document that check_keys found to be right. Notes required keys that are missing
// and what does not go together within one object. `skipped`: see Fields.
void read_fields(const nlohmann::json& document, const FieldList& list, const Reading& reading,
                 const std::string& skipped = "");

// The members of `list` as a document that states every key.
[[nodiscard]] nlohmann::json written_fields(const FieldList& list, const std::string& skipped = "");

// The same for a scene. Its name is that of the document, or else as it was.
void read_scene(const nlohmann::json& document, Scene& scene, const Reading& reading, const std::string& skipped = "");
[[nodiscard]] nlohmann::json written_scene(const Scene& scene, const std::string& skipped = "");

}  // namespace wade
