#pragma once
// A run as a JSON file.

#include <filesystem>
#include <string>

#include "known_failures.hpp"
#include "stability_case.hpp"

namespace wade::stability {

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
