#pragma once
// A validation case: a simulation with a known solution, and its error.
//
// A case is one file, case_NAME.cpp, with a function NAME_case() that cases.hpp declares and cases.cpp lists. The
// program `validate` runs it, thresholds.csv says which of its metrics are judged.

#include <cstddef>
#include <string>
#include <vector>

#include "configs/scene/scene.hpp"

namespace wade::validation {

// One number of a result. Errors are non-negative, so that smaller is better; thresholds.csv says which are judged.
struct Metric {
    std::string name;          // lower case with underscores, for example pressure_rms
    double value = 0;          // NaN: could not be measured, which fails a threshold
    std::string unit;          // "1" for a ratio
    double low = 0, high = 0;  // range of several starts, `value` is their median; else not used
};

// A table for a plot: simulated and true values side by side. The first column is the abscissa, every other one a curve
// over it. Columns named exact_* are drawn as lines (analytic truth), measured_* as points (published measurements),
// the rest as the simulation. NaN: no value in this row.
struct Curve {
    std::string name;                  // as a metric's; one plot each
    std::vector<std::string> columns;  // with units: x_m, depth_m, exact_depth_m
    std::vector<std::vector<double>> rows;
};

// What to run: the spacing is one of the case's, or another that was asked for; overrides are "/pointer=value" and are
// applied to each scene that the case loads.
struct Request {
    double spacing = 0;
    std::size_t level = 0;  // index of the case's resolution, for cases whose levels are numbers of runs
    std::vector<std::string> overrides;
    double gravity_factor = 1;             // of all scenes: starts differ by it, see Case::starts
    bool compares_with_finest_run = true;  // false: makes a new reference run where the truth is a stored run
};

struct Result {
    std::string model = "dfsph";
    std::size_t particles = 0;    // at the end
    std::size_t steps = 0;        // of the solver
    double particle_steps = 0;    // work: particles summed over steps
    double simulated_time = 0;    // s
    double solver_cpu_time = 0;   // s, without set-up and measurement
    double solver_wall_time = 0;  // s
    std::vector<Metric> metrics;
    std::vector<std::string> not_judged;  // metrics of the case that make no sense for this model of the fluid
    std::vector<Curve> curves;
};

struct Case {
    std::string name{};       // lower case with underscores
    std::string truth{};      // what it is compared with, with source; one or two sentences of the report
    std::string reference{};  // the same in a word or two, for a table: "Ritter 1892", "rho g z"
    // m: coarse, medium, fine; fewer if the case has fewer. A case without spacing counts its levels by another number
    // and says so in `truth`.
    std::vector<double> spacings{};
    bool quick = false;           // part of the tests, at quick_level
    std::size_t quick_level = 0;  // index in spacings
    std::size_t long_from = 3;    // this level and finer ones take hours and are run by request only
    // Where chance decides, as of fronts that break and single particles at edges: how many runs the medians are of, below the
    // level long_from. Their gravity differs by up to 0.02 %, which moves no truth as far as its limit tells.
    std::size_t starts = 1;
    Result (*run)(const Request& request) = nullptr;
};

// All cases, in the order of the report.
const std::vector<Case>& all_cases();

// What several runs come to: of each metric the median with the least and the largest value, work and time of all, the curves of
// the first.
Result medians_of(const std::vector<Result>& results);

// A scene of configs/ with the request's spacing and overrides. `sizes` are overrides that go before those of the
// request, for what depends on the spacing, such as the width of a slice. Unless an override sets fluid.max_particles it
// becomes what the scene needs: as much as its water at t = 0, an emitter's scene a quarter more.
Scene scene_for(const Request& request, const std::string& name, const std::vector<std::string>& sizes = {});

// "/pointer=value" with all digits of the number.
std::string assign(const std::string& pointer, double value);

}  // namespace wade::validation
