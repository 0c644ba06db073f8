#pragma once
// A validation case: a simulation whose truth is known, and what its error is.

#include <cstddef>
#include <string>
#include <vector>

#include "configs/scene.hpp"

namespace wade::validation {

// One number of a result. Errors are non-negative, so that smaller is better; thresholds.csv says which are judged.
struct Metric {
    std::string name;  // lower case with underscores, for example pressure_rms
    double value = 0;
    std::string unit;  // "1" for a ratio
};

// A table for a plot: simulated and true values side by side.
struct Curve {
    std::string name;
    std::vector<std::string> columns;  // with units: x_m, depth_m, exact_depth_m
    std::vector<std::vector<double>> rows;
};

// What to run: the spacing is one of the case's, or another that was asked for; overrides are "/pointer=value" and are
// applied to each scene that the case loads.
struct Request {
    double spacing = 0;
    std::vector<std::string> overrides;
};

struct Result {
    std::string model = "dfsph";
    std::size_t particles = 0;      // at the end
    std::size_t steps = 0;          // of the solver
    double particle_steps = 0;      // work: particles summed over steps
    double simulated_time = 0;      // s
    double solver_cpu_time = 0;     // s, without set-up and measurement
    double solver_wall_time = 0;    // s
    std::vector<Metric> metrics;
    std::vector<Curve> curves;
};

struct Case {
    std::string name;       // lower case with underscores
    std::string truth;      // what it is compared with, with source
    std::vector<double> spacings;  // m: coarse, medium, fine
    bool quick = false;     // part of the tests, at the coarse spacing
    Result (*run)(const Request& request) = nullptr;
};

// All cases, in the order of the report.
const std::vector<Case>& all_cases();

// A scene of configs/ with the request's spacing and overrides.
Scene scene_for(const Request& request, const std::string& name);

}  // namespace wade::validation
