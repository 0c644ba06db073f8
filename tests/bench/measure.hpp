#pragma once
// What a stretch of work takes: wall time, processor time, memory.

#include <cstdint>

namespace wade::bench {

double wall_seconds();  // of the steady clock
double cpu_seconds();   // of all threads of this process, user and system
double own_seconds();   // the same of the calling thread

// Both at once; the times of a stretch are differences.
struct Times {
    double wall = 0;
    double cpu = 0;
    [[nodiscard]] static Times now() { return {wall_seconds(), cpu_seconds()}; }
    [[nodiscard]] Times since(const Times& start) const { return {wall - start.wall, cpu - start.cpu}; }
};

// The most memory that this process held since the object was made, over what it held then.
class PeakMemory {
 public:
    PeakMemory();
    [[nodiscard]] std::uint64_t bytes() const;

 private:
    std::uint64_t before_;
};

}  // namespace wade::bench
