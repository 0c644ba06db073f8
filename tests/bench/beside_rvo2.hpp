#pragma once
// The crossing crowd beside RVO2, by a program built outside this repository from tools/rvo2/crossing.cpp.

#include <string>
#include <vector>

#include "tests/bench/bench_report.hpp"

namespace wade::bench {

// Runs both on the same starts and goals, shows cost and quality side by side, and adds them to the results. Throws
// std::runtime_error if the program does not do its part.
void show_beside_rvo2(const std::string& program, bool quick, std::vector<Result>& results);

}  // namespace wade::bench
