#pragma once
// Writes what a run found: runs/CASE-LEVEL.json and a CSV file a curve beside it, each complete or not there at all.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "thresholds.hpp"
#include "validation_case.hpp"

namespace wade::validation {

struct Record {
    const Case& what;
    std::string level;            // coarse, medium, fine, or spacing-0.05
    std::size_t level_index = 0;  // selects the thresholds
    Request request{};
    int threads = 1;
    std::size_t starts = 1;
    std::string fingerprint{};   // of program and scenes, given by the caller of the program
    std::string error{};         // why there is no result; empty: there is
    double whole_cpu_time = 0;   // of the process, with set-up and measurement, s
    double whole_wall_time = 0;  // s
    Result result{};
};

// Whether a value keeps its threshold; NaN does not.
bool keeps(double value, double threshold);

// Returns the file's name.
std::filesystem::path write_record(const std::filesystem::path& folder, const Record& record,
                                   const std::vector<Threshold>& thresholds);

}  // namespace wade::validation
