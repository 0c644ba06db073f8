#pragma once
// Measured series, and how they are shown.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace wade::bench {

// Returns quantile q in [0, 1] of `values` and sorts them; they must not be empty.
double quantile(std::vector<double>& values, double q);

// One line of the result: medians over rounds, so that one disturbed round does not count.
struct Result {
    std::string name;  // "protocol/frame_100k_ms"
    std::uint64_t size = 0;
    int threads = 1;
    double median = 0, min = 0, max = 0;
    std::string unit;
    // Counts of work, errors and further measures that stand beside the figure, with their unit in the name.
    std::vector<std::pair<std::string, double>> extra = {};
};
Result result_of(const std::string& name, std::uint64_t size, int threads, std::vector<double> rounds,
                 const std::string& unit);

// A line of the result and, indented below it, what stands beside it.
void print(const Result& result);

// "AMD EPYC 7B13, 2 processors, 24 GiB, Linux 6.1.0"
std::string machine();

// {"machine": ..., "results": [{"name", "size", "threads", "median", "min", "max", "unit", further measures}, ...]}
void write_json(const std::string& file, const std::vector<Result>& results);

}  // namespace wade::bench
