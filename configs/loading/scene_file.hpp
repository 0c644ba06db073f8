#pragma once
// From text to one merged JSON document: parsing, and the chain of files that extend one another.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "configs/errors/problems.hpp"
#include "configs/files/text_file.hpp"
#include "configs/json/json.hpp"

namespace wade {

// Parses JSON with // and /* */ comments; refuses keys that stand twice in one object. Errors give line and column.
[[nodiscard]] Json parse_scene_text(std::string_view text, const std::string& source);

// Lays `upper` over `lower`: objects merge key by key, everything else is replaced.
void merge_over(Json& lower, const Json& upper);

// Parses the text of `file` and reads the files that it extends, at most 32, each checked against the keys on its own; `file`
// is the last. Throws one ConfigurationError for all mistakes of keys and values in them.
[[nodiscard]] std::vector<Json> scene_layers(std::string_view text, const std::filesystem::path& file);

// Merges each over those before it. name and description are those of the last alone; the result has neither "extends"
// nor "$schema".
[[nodiscard]] Json merge_layers(const std::vector<Json>& layers);

// Replaces each `people_csv`, of the crowd or of a group, by the people of the table that it names. The first line of a
// table holds keys of /crowd/people, each further line a person. Paths are relative to the folder of `scene_file`.
// Notes faults with file, line, column, value and what is allowed.
void take_people(Json& document, const std::filesystem::path& scene_file, Problems& problems);

// Makes the paths that keys of `document` name absolute: they are relative to `folder`.
void make_paths_absolute(Json& document, const std::filesystem::path& folder);

// Replaces each path by a hash of the file's contents, so that scenes of equal contents have equal texts.
void put_contents_for_paths(Json& document);

}  // namespace wade
