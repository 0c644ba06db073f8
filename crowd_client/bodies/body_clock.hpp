#pragma once
// When people with bodies decide and move: about as often at any rate of steps.
//
// They decide every 0.1 s, or a little more often. A step of the crowd that is longer has parts, in each of which they
// decide and walk through the same water; of shorter ones some pass between two decisions. A motion takes at most 0.05 s.
//
// Decisions every 0.067 s serve people better by 3 % (goals that they reach in a crossing crowd) and cost 1.4 times as much.

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace wade::crowd {

struct BodyClock {
    int parts = 1;                    // of a step of the crowd
    std::uint64_t steps_between = 1;  // decisions, if a step is one part
};

// One decision among all.
struct Decision {
    std::uint64_t number = 0;  // from 0
    double time = 0.1;         // T to the next, s

    // Whether it is one of those that are about `every` s apart.
    [[nodiscard]] bool is_due(double every) const { return number % between(every) == 0; }
    // How long those are apart, s.
    [[nodiscard]] double interval(double every) const { return static_cast<double>(between(every)) * time; }

 private:
    [[nodiscard]] std::uint64_t between(double every) const {
        return static_cast<std::uint64_t>(std::max(1L, std::lround(every / time)));
    }
};

inline constexpr double longest_decision = 0.1;  // s
inline constexpr double longest_motion = 0.05;   // s
inline constexpr double rounding = 1e-6;         // of counts, so that 0.1 s at 30 Hz are 3 steps

[[nodiscard]] inline BodyClock body_clock(double dt) {
    BodyClock clock;
    clock.parts = static_cast<int>(std::ceil(dt / longest_decision - rounding));
    if (clock.parts == 1) clock.steps_between = static_cast<std::uint64_t>(longest_decision / dt + rounding);
    return clock;
}

// Motions in a time, s.
[[nodiscard]] inline int motions_in(double time) {
    return std::max(1, static_cast<int>(std::ceil(time / longest_motion - rounding)));
}

}  // namespace wade::crowd
