#pragma once
// What is written from the keys for people and editors: configs/scene.schema.json and the table of docs/scene_keys.md.

#include <string>
#include <vector>

#include "configs/scene/keys.hpp"

namespace wade {

// JSON Schema 2020-12 of scene files. What only a whole scene must have, not one that extends another, stands under "else".
[[nodiscard]] std::string schema_text(const KeyNode& keys);

// One row for each key in Markdown: key, unit, range, default, meaning.
[[nodiscard]] std::string keys_table(const KeyNode& keys);

// A file of the project that is written from the keys, relative to the project's root. `ninja scene_documents` writes all.
struct SceneDocument {
    std::string file;
    std::string text;
};
[[nodiscard]] std::vector<SceneDocument> scene_documents();

}  // namespace wade
