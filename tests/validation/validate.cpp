// Runs one validation case and writes what it found; tools/validate.sh runs them all and writes the report.

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "record.hpp"
#include "run.hpp"
#include "thresholds.hpp"

using namespace wade;
using namespace wade::validation;

namespace {

const char* const help = R"(Usage: validate --case NAME [--level LEVEL | --spacing D] [options]
       validate --list

Runs one validation case: a simulation whose truth is known. tools/validate.sh runs all of them and writes the report.

  --list             All cases: name, spacings in m of coarse, medium and fine, and, each if it holds, the words
                     quick=LEVEL (part of the tests), long=LEVEL (from there on it takes hours) and starts=N (chance
                     decides there: the report takes the medians of N starts below the long level)
  --case NAME        Which case
  --level LEVEL      coarse (default), medium or fine
  --spacing D        Another spacing of the particles, m; the thresholds are those of the next coarser level
  --no-reference     Without the comparison with a stored run of our own (impulse_*): to make that run anew
  --set /PTR=VALUE   Sets a value of each scene that the case loads; may be given several times
  --starts N         N runs, 1 to 99, whose gravity differs by 0.01 % and more: of all metrics the medians (default: 1)
  --threads N        Threads, 1 to 1024 (default: as many as there are processors)
  --out DIR          Folder in which runs/NAME-LEVEL.json and its curves are written (default: nothing is written)
  --check            Exit code 1 if a metric is above its threshold and not a known failure
  --fingerprint TEXT Kept in the JSON file, so that a script knows whether the run is still up to date
  --help             This text

Exit codes: 0 ok, 1 above a threshold or unexpected, 2 bad usage or scene, 9 numerical failure.
)";

struct Options {
    bool list = false;
    bool check = false;
    bool no_reference = false;
    std::string case_name;
    std::string level;
    std::optional<double> spacing;
    std::vector<std::string> overrides;
    int threads = 0;
    std::size_t starts = 1;
    std::string out;
    std::string fingerprint;
};

double number_of(const std::string& option, const std::string& text, double lo, double hi, bool whole) {
    try {
        std::size_t end = 0;
        const double value = std::stod(text, &end);
        if (end == text.size() && value >= lo && value <= hi && (!whole || value == std::floor(value))) {
            return value;
        }
    } catch (const std::exception&) {
    }
    char range[80];
    std::snprintf(range, sizeof range, "a %snumber from %g to %g", whole ? "whole " : "", lo, hi);
    throw ConfigurationError(option + " " + text + ": allowed: " + range + ".");
}

Options read_options(const std::vector<std::string>& arguments) {
    Options options;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        const std::string& option = arguments[i];
        const auto value = [&]() -> const std::string& {
            if (i + 1 == arguments.size()) {
                throw ConfigurationError(option + " needs a value; see --help.");
            }
            return arguments[++i];
        };
        if (option == "--list") {
            options.list = true;
        } else if (option == "--check") {
            options.check = true;
        } else if (option == "--no-reference") {
            options.no_reference = true;
        } else if (option == "--case") {
            options.case_name = value();
        } else if (option == "--level") {
            options.level = value();
        } else if (option == "--spacing") {
            options.spacing = number_of(option, value(), 1e-6, 1e6, false);
        } else if (option == "--set") {
            options.overrides.push_back(value());
        } else if (option == "--threads") {
            options.threads = static_cast<int>(number_of(option, value(), 1, 1024, true));
        } else if (option == "--starts") {
            options.starts = static_cast<std::size_t>(number_of(option, value(), 1, 99, true));
        } else if (option == "--out") {
            options.out = value();
        } else if (option == "--fingerprint") {
            options.fingerprint = value();
        } else {
            throw ConfigurationError("unknown option " + option + "; see --help.");
        }
    }
    return options;
}

void print_list() {
    for (const Case& what : all_cases()) {
        std::cout << what.name;
        for (const double spacing : what.spacings) {
            std::cout << ' ' << spacing;
        }
        if (what.quick) {
            std::cout << " quick=" << level_names.at(what.quick_level);
        }
        if (what.long_from < what.spacings.size()) {
            std::cout << " long=" << level_names.at(what.long_from);
        }
        if (what.starts > 1) {
            std::cout << " starts=" << what.starts;
        }
        std::cout << '\n';
    }
}

const Case& case_named(const std::string& name) {
    std::string names;
    for (const Case& what : all_cases()) {
        if (what.name == name) {
            return what;
        }
        names += (names.empty() ? "" : ", ") + what.name;
    }
    throw ConfigurationError("--case " + name + ": allowed: " + names + ".");
}

Record make_record(const Options& options) {
    if (options.case_name.empty()) {
        throw ConfigurationError("which case? --case NAME or --list; see --help.");
    }
    if (!options.level.empty() && options.spacing) {
        throw ConfigurationError("--level and --spacing both say how fine to run; give one of them.");
    }
    const Case& what = case_named(options.case_name);
    Record record{.what = what, .level = options.level.empty() ? "coarse" : options.level, .level_index = 0};
    record.request.overrides = options.overrides;
    record.request.compares_with_finest_run = !options.no_reference;
    record.fingerprint = options.fingerprint;
    record.starts = options.starts;
    if (options.spacing) {
        char text[40];
        std::snprintf(text, sizeof text, "spacing-%g", *options.spacing);
        record.level = text;
        record.request.spacing = *options.spacing;
        while (record.level_index + 1 < what.spacings.size() &&
               *options.spacing <= what.spacings[record.level_index + 1] * (1 + 1e-9)) {
            ++record.level_index;
        }
        record.request.level = record.level_index;
        return record;
    }
    const auto level = std::find(level_names.begin(), level_names.end(), record.level);
    record.level_index = static_cast<std::size_t>(level - level_names.begin());
    if (record.level_index >= what.spacings.size()) {
        std::string names;
        for (std::size_t i = 0; i < what.spacings.size(); ++i) {
            names += std::string(i > 0 ? ", " : "") + level_names.at(i);
        }
        throw ConfigurationError("--level " + record.level + ": allowed for " + what.name + ": " + names + ".");
    }
    record.request.spacing = what.spacings[record.level_index];
    record.request.level = record.level_index;
    return record;
}

// Adds each metric that has a threshold but is missing in the run, as not measured, so that the check and the report
// fail and name it. Metrics that the model of the fluid cannot have are exempt.
void add_missing_metrics(const std::vector<Threshold>& thresholds, Record& record) {
    for (const Threshold& row : thresholds) {
        if (row.case_name != record.what.name || !row.levels.at(record.level_index)) continue;
        std::vector<Metric>& metrics = record.result.metrics;
        if (std::any_of(metrics.begin(), metrics.end(), [&](const Metric& m) { return m.name == row.metric; }))
            continue;
        const std::vector<std::string>& not_judged = record.result.not_judged;
        if (std::find(not_judged.begin(), not_judged.end(), row.metric) != not_judged.end()) continue;
        std::cerr << "validate: " << row.case_name << ": thresholds.csv judges the metric " << row.metric
                  << ", which this run did not measure\n";
        metrics.push_back({row.metric, std::numeric_limits<double>::quiet_NaN(), "1"});
    }
}

// Prints the metrics; false if one is above its threshold and, if it is known to be, above its guard.
bool print_verdict(const Record& record, const std::vector<Threshold>& thresholds,
                   const std::vector<KnownFailure>& known) {
    const Result& result = record.result;
    std::printf("%s %s: spacing %g m, %zu particles, %zu steps, %g s simulated in %.2f s of CPU\n",
                record.what.name.c_str(), record.level.c_str(), record.request.spacing, result.particles, result.steps,
                result.simulated_time, result.solver_cpu_time);
    bool passed = true;
    for (const Metric& metric : result.metrics) {
        const auto threshold = threshold_of(thresholds, record.what.name, metric.name, record.level_index);
        std::printf("  %-32s %12.6g %-8s", metric.name.c_str(), metric.value, metric.unit.c_str());
        if (threshold) {
            const bool pass = keeps(metric.value, *threshold);
            const auto guard = guard_of(known, record.what.name, metric.name, record.level_index);
            const bool guarded = guard && keeps(metric.value, *guard);
            passed = passed && (pass || guarded);
            std::printf(" <= %-8g %s", *threshold, pass ? "ok" : guarded ? "FAILED (known)" : "FAILED");
        }
        if (record.starts > 1) std::printf(" (%zu starts: %g to %g)", record.starts, metric.low, metric.high);
        std::printf("\n");
    }
    return passed;
}

// Starts 0, 1, 2, ... have 1, 1 + e, 1 - e, 1 + 2e, ... times the gravity, so that five differ by 0.02 % at most.
Result run_all_starts(const Record& record) {
    if (record.starts == 1) return record.what.run(record.request);
    constexpr double e = 1e-4;
    std::vector<Result> results;
    for (std::size_t k = 0; k < record.starts; ++k) {
        Request request = record.request;
        request.gravity_factor = 1 + (k % 2 == 1 ? e : -e) * static_cast<double>((k + 1) / 2);
        results.push_back(record.what.run(request));
    }
    return medians_of(results);
}

int run(const Options& options) {
    if (options.list) {
        print_list();
        return 0;
    }
    Record record = make_record(options);
    const std::filesystem::path tables = WADE_VALIDATION;
    const std::vector<Threshold> thresholds = read_thresholds(tables / "thresholds.csv");
    const std::vector<KnownFailure> known = read_known_failures(tables / "known_failures.csv");
    if (options.threads > 0) {
        omp_set_num_threads(options.threads);
    }
    record.threads = omp_get_max_threads();
    const double wall = wall_time();
    int code = 0;
    try {
        record.result = run_all_starts(record);
    } catch (const RunError& error) {
        if (error.code() != ExitCode::numerical_failure) {
            throw;
        }
        record.error = error.what();
        code = static_cast<int>(error.code());
        std::cerr << "validate: " << record.what.name << " " << record.level << ": " << record.error << '\n';
    }
    record.whole_cpu_time = process_cpu_time();
    record.whole_wall_time = wall_time() - wall;
    if (record.error.empty()) add_missing_metrics(thresholds, record);
    const bool passed = print_verdict(record, thresholds, known);
    if (!options.out.empty()) {
        std::cout << "  " << write_record(std::filesystem::path(options.out) / "runs", record, thresholds).string()
                  << '\n';
    }
    return code == 0 && options.check && !passed ? 1 : code;
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> arguments(argv + 1, argv + argc);
    if (std::find(arguments.begin(), arguments.end(), "--help") != arguments.end()) {
        std::cout << help;
        return 0;
    }
    try {
        return run(read_options(arguments));
    } catch (const RunError& error) {
        std::cerr << "validate: " << error.what() << '\n';
        return static_cast<int>(error.code());
    } catch (const std::exception& error) {
        std::cerr << "validate: " << error.what() << '\n';
        return 1;
    }
}
