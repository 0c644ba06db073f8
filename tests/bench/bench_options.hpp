#pragma once
// The options that every benchmark has, and its main().

#include <functional>
#include <string>
#include <vector>

#include "tests/bench/bench_report.hpp"

namespace wade::bench {

struct Options {
    bool quick = false;  // --quick: fewer and smaller cases, for a look at a change
    std::string json;    // --json FILE; empty: none
    std::string only;    // --only NAME: names that begin like this; empty: all
    int threads = 0;     // --threads N: this number only; 0: one, and all processors
    [[nodiscard]] bool wanted(const std::string& name) const { return name.rfind(only, 0) == 0; }
    [[nodiscard]] std::vector<int> thread_counts() const;
};

// Reads the options, prints the machine, runs, prints each result, writes the file. The exit code is 2 for a mistake in the
// options, 1 for any other error.
int run_program(const char* program, int argc, char** argv,
                const std::function<void(const Options&, std::vector<Result>&)>& run);

}  // namespace wade::bench
