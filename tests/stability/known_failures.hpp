#pragma once
// Rules that are known to be broken: known_failures.csv, a line each with the evidence for why it is not mended.

#include <filesystem>
#include <string>
#include <vector>

#include "stability_case.hpp"

namespace wade::stability {

struct KnownFailure {
    std::string name;     // of the case
    std::string setting;  // name of the solver settings; * = all
    std::string rule;     // name of the check
    double guard = 0;     // the value may not be worse than this
    std::string reason;
};

// Columns case,setting,rule,guard,reason; the reason may hold commas. Throws ConfigurationError with file, line and value.
[[nodiscard]] std::vector<KnownFailure> read_known_failures(const std::filesystem::path& file);

// Whether a check that does not pass is a known failure within its guard.
[[nodiscard]] bool is_known(const std::vector<KnownFailure>& all, const std::string& name, const std::string& setting,
                            const Check& check);

}  // namespace wade::stability
