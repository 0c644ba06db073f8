#pragma once
// People of a site from a table.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "configs/scene/fields/people.hpp"

namespace wade {

// Reads a table of residents. Its first line names the columns: x and y, m in the site's coordinate system, and
// optionally id, age (years), sex (female, male), height (m), mass (kg), skill, group and leaves_at (s). Values have
// the limits of their keys in a scene. An empty cell sets nothing, but x and y are required. Throws ConfigurationError
// that names file, line, value and remedy.
[[nodiscard]] std::vector<Resident> read_residents(const std::filesystem::path& file);
[[nodiscard]] std::vector<Resident> parse_residents(std::string_view text, const std::string& name);

}  // namespace wade
