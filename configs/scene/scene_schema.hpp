#pragma once
// Checks JSON values against scene.schema.json and completes them with its defaults.
//
// The schema uses these keywords of JSON Schema 2020-12, and this file no others: type (one, or a list of those that a
// value may have), properties, required,
// additionalProperties (false), items, enum, minimum, maximum, exclusiveMinimum, exclusiveMaximum, minLength,
// maxLength, pattern, default.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace wade {

// The parsed schema.
[[nodiscard]] const nlohmann::json& scene_schema();

// Checks that `value`, at `pointer` of what `source` names, has only known keys, the right types and allowed values.
// Required keys may be missing: a file that another extends, or that extends another, is only a part of a scene.
void check_against_schema(const nlohmann::json& value, const nlohmann::json& schema, const std::string& pointer,
                          const std::string& source);

// Adds every default to `value`, gives numbers the type that the schema states, and checks that no required key is
// missing.
void complete_with_defaults(nlohmann::json& value, const nlohmann::json& schema, const std::string& pointer,
                            const std::string& source);

// The type that `value` is to have: the schema's, or the one of several that fits, else the first.
[[nodiscard]] std::string type_for(const nlohmann::json& value, const nlohmann::json& schema);

// `pointer` extended by one key, escaped as RFC 6901 demands.
[[nodiscard]] std::string pointer_to(const std::string& pointer, const std::string& key);

// Throws that `key`, in the object at `pointer`, is not known there, and names the nearest key that is.
[[noreturn]] void throw_unknown_key(const nlohmann::json& object_schema, const std::string& key,
                                    const std::string& pointer, const std::string& source);

// The allowed values of a schema as words with unit, for example "> 0 and <= 2 s".
[[nodiscard]] std::string allowed_values(const nlohmann::json& schema);

// The embedded text of scene.schema.json.
[[nodiscard]] std::string_view scene_schema_text();

}  // namespace wade
