#pragma once
// A run as a JSON file, and its verdict.

#include <filesystem>
#include <string>
#include <vector>

#include "stability_case.hpp"

namespace wade::stability {

// Rules that are known to be broken: known_failures.csv, a line each with the evidence for why it is not mended.
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

// What was run, beside the case.
struct Run {
    std::string setting = "default";
    std::vector<std::string> overrides;
    int threads = 1;
    bool quick = false, long_form = false;
    std::string fingerprint;  // of the program and its scenes, given by the caller
};

// "pass", "known" (every rule that is broken is a known failure) or "fail".
[[nodiscard]] std::string verdict(const Case& hard_case, const Run& run, const Result& result,
                                  const std::vector<KnownFailure>& known);

[[nodiscard]] std::string record_text(const Case& hard_case, const Run& run, const Result& result,
                                      const std::vector<KnownFailure>& known);

// Writes through a second file, so that one of this name is always complete. Throws std::runtime_error.
void write_record(const std::filesystem::path& file, const std::string& text);

}  // namespace wade::stability
