#pragma once
// Applies values from the command line to a merged scene document.

#include <string>

#include "configs/json/json.hpp"

namespace wade {

// One value set from outside the scene file, applied after the merge.
struct SceneOverride {
    std::string pointer;  // JSON pointer of a key that the schema knows, for example "/crowd/groups/0/tau"
    std::string value;    // JSON, or else a plain string
    std::string source;   // named in errors, for example "--set /seed=7"
};

// Splits "/json/pointer=value"; throws ConfigurationError if that is not its form.
[[nodiscard]] SceneOverride parse_override(const std::string& assignment);

// Sets one value; its pointer must exist in the schema, missing objects along it are created. In an array the index may
// be that of an element or, to append, the number of elements.
void apply_override(Json& document, const SceneOverride& change);

}  // namespace wade
