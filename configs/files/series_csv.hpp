#pragma once
// Values in time from a table.

#include <filesystem>
#include <string>
#include <string_view>

#include "configs/scene/fields.hpp"
#include "configs/scene/site.hpp"

namespace wade {

// A table with the names of its columns in the first line, time_s and that of the key, in any order. Times may stand still, which
// is a jump, and never go back. Values are held to the limits of the key, as one in the scene, and are no mark of missing data,
// such as -9999. Throws ConfigurationError that names file, line, value and remedy.
[[nodiscard]] Series read_series(const std::filesystem::path& file, const Key& key);
[[nodiscard]] Series parse_series(std::string_view text, const std::string& name, const Key& key);

}  // namespace wade
