#pragma once
// Measures the wall time of the stages of a step.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace wade::crowd {

struct StepTimes {
    std::uint64_t steps = 0;
    std::vector<double> seconds;  // of wall time over all steps, by stage
};

// Runs a stage, and adds its wall time to `times`, if that is not null.
template <typename Work>
void timed(StepTimes* times, std::size_t stage, Work&& work) {
    if (times == nullptr) return work();
    using Clock = std::chrono::steady_clock;
    const Clock::time_point begin = Clock::now();
    work();
    if (times->seconds.size() <= stage) times->seconds.resize(stage + 1);
    times->seconds[stage] += std::chrono::duration<double>(Clock::now() - begin).count();
}

}  // namespace wade::crowd
