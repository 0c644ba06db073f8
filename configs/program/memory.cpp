#include "configs/program/memory.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>

#include "configs/errors/exit_code.hpp"

namespace wade {

namespace {

constexpr double unknown = std::numeric_limits<double>::infinity();

// Of the line "NAME: 123 kB" of a file.
double kilobytes_of(const char* file, const std::string& name) {
    std::ifstream lines(file);
    for (std::string word; lines >> word;) {
        double value = 0;
        if (word == name && lines >> value) return 1024 * value;
    }
    return unknown;
}

double number_in(const std::string& file) {
    std::ifstream text(file);
    double value = 0;
    return text >> value ? value : unknown;  // "max" is no number
}

// Of version 2: the group's folder is the line "0::/..." of /proc/self/cgroup. Limits of the groups above count, too.
double left_to_group() {
    std::ifstream groups("/proc/self/cgroup");
    double left = unknown;
    for (std::string line; std::getline(groups, line);) {
        if (line.rfind("0::", 0) != 0) continue;
        for (std::string path = line.substr(3);; path.resize(path.rfind('/'))) {
            const std::string folder = "/sys/fs/cgroup" + path;
            const double limit = number_in(folder + "/memory.max"), used = number_in(folder + "/memory.current");
            if (limit < unknown && used < unknown) left = std::min(left, std::max(0.0, limit - used));
            if (path.find('/') == std::string::npos) break;
        }
    }
    return left;
}

double left_of_address_space() {
    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return unknown;
    const double used = kilobytes_of("/proc/self/status", "VmSize:");
    return std::max(0.0, static_cast<double>(limit.rlim_cur) - (used < unknown ? used : 0));
}

std::string gigabytes(double bytes) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.3g GB", 1e-9 * bytes);
    return text.data();
}

}  // namespace

std::string memory_text(double bytes) {
    if (bytes >= 1e9) return gigabytes(bytes);
    return std::to_string(static_cast<long>(std::ceil(1e-6 * bytes))) + " MB";
}

double available_memory() {
    return std::min({kilobytes_of("/proc/meminfo", "MemAvailable:"), left_to_group(), left_of_address_space()});
}

void check_memory(double needed, double available, const std::string& source, const std::string& advice) {
    if (needed <= available) return;
    throw ConfigurationError(source + ": needs about " + gigabytes(needed) + " of memory, " + gigabytes(available) +
                             " are left; " + advice);
}

}  // namespace wade
