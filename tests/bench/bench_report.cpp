#include "tests/bench/bench_report.hpp"

#include <sys/sysinfo.h>
#include <sys/utsname.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "configs/json/json.hpp"

namespace wade::bench {

double quantile(std::vector<double>& values, double q) {
    std::sort(values.begin(), values.end());
    const auto last = static_cast<double>(values.size() - 1);
    return values[static_cast<std::size_t>(std::lround(q * last))];
}

Result result_of(const std::string& name, std::uint64_t size, int threads, std::vector<double> rounds,
                 const std::string& unit) {
    const double median = quantile(rounds, 0.5);
    return {name, size, threads, median, rounds.front(), rounds.back(), unit};
}

void print(const Result& r) {
    std::printf("%-28s %9llu %2d threads %14.6g %s (%.6g to %.6g)\n", r.name.c_str(),
                static_cast<unsigned long long>(r.size), r.threads, r.median, r.unit.c_str(), r.min, r.max);
    constexpr std::size_t on_a_line = 4;
    for (std::size_t k = 0; k < r.extra.size(); ++k) {
        const auto& [name, value] = r.extra[k];
        std::printf("%s%s %.4g", k % on_a_line == 0 ? "    " : ", ", name.c_str(), value);
        if (k % on_a_line + 1 == on_a_line || k + 1 == r.extra.size()) std::printf("\n");
    }
    std::fflush(stdout);
}

std::string machine() {
    std::ifstream cpuinfo("/proc/cpuinfo");
    std::string model = "unknown processor";
    for (std::string line; std::getline(cpuinfo, line);) {
        if (line.rfind("model name", 0) != 0) continue;
        model = line.substr(line.find(':') + 2);
        break;
    }
    struct sysinfo memory {};
    sysinfo(&memory);
    struct utsname kernel {};
    uname(&kernel);
    const double gibibytes = static_cast<double>(memory.totalram) * memory.mem_unit / (1024.0 * 1024 * 1024);
    return model + ", " + std::to_string(std::thread::hardware_concurrency()) + " processors, " +
           std::to_string(std::lround(gibibytes)) + " GiB, " + kernel.sysname + " " + kernel.release;
}

void write_json(const std::string& file, const std::vector<Result>& results) {
    Json list = Json::array();
    for (const Result& r : results) {
        Json entry{{"name", r.name}, {"size", r.size}, {"threads", r.threads}, {"median", r.median},
                   {"min", r.min},   {"max", r.max},   {"unit", r.unit}};
        for (const auto& [name, value] : r.extra) entry[name] = value;
        list.push_back(std::move(entry));
    }
    std::ofstream out(file);
    out << Json{{"machine", machine()}, {"results", list}}.dump({.indent = 2}) << '\n';
    if (!out.flush()) throw std::runtime_error("--json: " + file + " cannot be written");
}

}  // namespace wade::bench
