#include "record.hpp"

#include <unistd.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "configs/errors/exit_code.hpp"
#include "configs/json/json.hpp"
#include "configs/program/version.hpp"

namespace wade::validation {

namespace {

std::string processor() {
    std::ifstream in("/proc/cpuinfo");
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with("model name")) {
            return line.substr(line.find(':') + 2);
        }
    }
    return "unknown";
}

// A reader never meets half a file.
void write_whole(const std::filesystem::path& file, const std::string& text) {
    std::filesystem::path part = file;
    part += ".part" + std::to_string(getpid());
    std::ofstream out(part);
    out << text;
    out.close();
    if (!out) {
        std::filesystem::remove(part);
        throw RunError(ExitCode::unexpected, "cannot write " + file.string() + ": is the disk full?");
    }
    std::filesystem::rename(part, file);
}

std::string csv_text(const Curve& curve) {
    std::ostringstream text;
    text.precision(9);
    for (std::size_t c = 0; c < curve.columns.size(); ++c) {
        text << (c > 0 ? "," : "") << curve.columns[c];
    }
    for (const std::vector<double>& row : curve.rows) {
        for (std::size_t c = 0; c < row.size(); ++c) {
            text << (c > 0 ? "," : "\n");
            if (!std::isnan(row[c])) {
                text << row[c];
            }
        }
    }
    text << '\n';
    return text.str();
}

Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

}  // namespace

bool keeps(double value, double threshold) {
    return value <= threshold;  // false for NaN
}

std::filesystem::path write_record(const std::filesystem::path& folder, const Record& record,
                                   const std::vector<Threshold>& thresholds) {
    std::filesystem::create_directories(folder);
    const std::string stem = record.what.name + "-" + record.level;
    const Result& result = record.result;
    Json metrics = Json::array();
    for (const Metric& metric : result.metrics) {
        const auto threshold = threshold_of(thresholds, record.what.name, metric.name, record.level_index);
        metrics.push_back({{"name", metric.name}, {"value", number(metric.value)}, {"unit", metric.unit}});
        if (record.starts > 1) {
            metrics.back()["low"] = number(metric.low);
            metrics.back()["high"] = number(metric.high);
        }
        metrics.back()["threshold"] = threshold ? Json(*threshold) : Json(nullptr);
        metrics.back()["pass"] = threshold ? Json(keeps(metric.value, *threshold)) : Json(nullptr);
    }
    Json curves = Json::array();
    for (const Curve& curve : result.curves) {
        const std::string file = stem + "-" + curve.name + ".csv";
        write_whole(folder / file, csv_text(curve));
        curves.push_back({{"name", curve.name}, {"file", file}, {"columns", curve.columns}});
    }
    const Json document{{"case", record.what.name},
                        {"level", record.level},
                        {"status", record.error.empty() ? "completed" : "failed"},
                        {"error", record.error},
                        {"truth", record.what.truth},
                        {"reference", record.what.reference},
                        {"model", result.model},
                        {"spacing_m", record.request.spacing},
                        {"overrides", record.request.overrides},
                        {"particles", result.particles},
                        {"steps", result.steps},
                        {"particle_steps", result.particle_steps},
                        {"simulated_s", result.simulated_time},
                        {"solver_cpu_s", result.solver_cpu_time},
                        {"solver_wall_s", result.solver_wall_time},
                        {"cpu_s", record.whole_cpu_time},
                        {"wall_s", record.whole_wall_time},
                        {"threads", record.threads},
                        {"starts", record.starts},
                        {"processor", processor()},
                        {"processors", sysconf(_SC_NPROCESSORS_ONLN)},
                        {"compiler", compiler()},
                        {"version", version()},
                        {"git", git_hash()},
                        {"fingerprint", record.fingerprint},
                        {"metrics", metrics},
                        {"curves", curves}};
    const std::filesystem::path file = folder / (stem + ".json");
    write_whole(file, document.dump({.indent = 2}) + "\n");
    return file;
}

}  // namespace wade::validation
