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

inline constexpr std::array<const char*, 3> level_names{"coarse", "medium", "fine"};

// Thresholds that are missed, known_failures.csv: case,metric,level,guard,reason.
//
// The threshold stays what it is and the report says that it is missed. `validate --check`, and so the tests, end with an
// error only if the value is above the guard as well, which stands a little above what was measured: it notices when a
// known failure grows. The level is coarse, medium or fine.
struct KnownFailure {
    std::string case_name;
    std::string metric;
    std::string level;
    double guard = 0;
    std::string reason;
};

// Throws ConfigurationError with file, line and value.
std::vector<KnownFailure> read_known_failures(const std::filesystem::path& file);

// None: not known to fail. level: 0 coarse, 1 medium, 2 fine
std::optional<double> guard_of(const std::vector<KnownFailure>& all, const std::string& case_name,
                               const std::string& metric, std::size_t level);

}  // namespace wade::validation
