#pragma once
// Values in time from a table.

#include <filesystem>
#include <limits>
#include <string>
#include <string_view>

#include "configs/scene/place.hpp"

namespace wade {

// A table whose first line names its columns, time_s and `column` among them; of two columns the second may have any name.
// Lines that begin with '#' are left out. Times may stand still, which is a jump, and never go back; values lie
// between `least` and `most` and are no mark of missing data, such as -9999. Throws ConfigurationError that names file, line,
// value and remedy.
[[nodiscard]] Series read_series(const std::filesystem::path& file, const std::string& column, double least,
                                 double most = std::numeric_limits<double>::infinity());
[[nodiscard]] Series parse_series(std::string_view text, const std::string& name, const std::string& column,
                                  double least, double most = std::numeric_limits<double>::infinity());

}  // namespace wade
