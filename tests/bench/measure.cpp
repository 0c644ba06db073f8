#include "tests/bench/measure.hpp"

#include <malloc.h>

#include <chrono>
#include <ctime>
#include <fstream>
#include <string>

namespace wade::bench {
namespace {

// A line of /proc/self/status, in bytes.
std::uint64_t status_bytes(const std::string& key) {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
        if (line.rfind(key + ":", 0) == 0) return 1024 * std::stoull(line.substr(key.size() + 1));
    }
    return 0;
}

double clock_seconds(clockid_t clock) {
    timespec t{};
    clock_gettime(clock, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

double wall_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double cpu_seconds() {
    return clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
}

double own_seconds() {
    return clock_seconds(CLOCK_THREAD_CPUTIME_ID);
}

PeakMemory::PeakMemory() {
    malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << "5";  // sets the peak back to what is held now
    before_ = status_bytes("VmRSS");
}

std::uint64_t PeakMemory::bytes() const {
    const std::uint64_t peak = status_bytes("VmHWM");
    return peak > before_ ? peak - before_ : 0;
}

}  // namespace wade::bench
