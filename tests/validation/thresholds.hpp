#pragma once
// Which metrics are judged: thresholds.csv, written before the results are seen.
//
//   case,metric,coarse,medium,fine,reason
//
// A metric passes if it is not above the threshold of its level. "-": reported only. An empty medium is that of coarse, an
// empty fine that of medium. The reason is the rest of the line and may hold commas.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace wade::validation {

struct Threshold {
    std::string case_name;
    std::string metric;
    std::array<std::optional<double>, 3> levels;  // coarse, medium, fine
    std::string reason;
};

// Throws ConfigurationError with file, line and value.
std::vector<Threshold> read_thresholds(const std::filesystem::path& file);

// That of a metric at a level; none: reported only.
std::optional<double> threshold_of(const std::vector<Threshold>& all, const std::string& case_name,
                                   const std::string& metric, std::size_t level);

}  // namespace wade::validation
