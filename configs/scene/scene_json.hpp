#pragma once
// From JSON to the members that a list of fields names, and back.

#include <string>

#include "configs/json/json.hpp"
#include "configs/scene/keys.hpp"

namespace wade {

// Sets the members of `list` from a merged document that check_keys found to be right. Notes required keys that are missing
// and what does not go together within one object. `skipped`: see Fields.
void read_fields(const Json& document, const FieldList& list, const Reading& reading, const std::string& skipped = "");

// The members of `list` as a document that states every key.
[[nodiscard]] Json written_fields(const FieldList& list, const std::string& skipped = "");

// The same for a scene. Its name is that of the document, or else as it was.
void read_scene(const Json& document, Scene& scene, const Reading& reading, const std::string& skipped = "");
[[nodiscard]] Json written_scene(const Scene& scene, const std::string& skipped = "");

}  // namespace wade
