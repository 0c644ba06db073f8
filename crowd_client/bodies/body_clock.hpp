#pragma once
// Decision and motion times of agents with bodies: about as often at any time step. With the response `measured`,
// agents without bodies also move in parts of a step. All other agents do so in steps above 0.5 s.
//
// Agents decide every 0.1 s, or a little more often. A longer step of the crowd is divided into parts; each part is one
// decision and walk through the same water. With shorter steps, several pass between two decisions. A motion takes at
// most 0.06 s. A step of up to 0.118 s is not divided. So decisions are rarest at 8.5 steps a second: one a step, with
// two motions each.
//
// With decisions every 0.067 s a crossing crowd reaches 3 % more goals at 1.4 times the cost, with decisions every
// 0.118 s 2 % fewer at 0.87 times the cost. A crowd gets through a door in 0.96, 1 and 1.03 times the time that it
// takes at 30 steps a second. With decisions every 0.125 s it was 1.04 (`fast`) and 1.06 (`human`), above the tolerance
// of 5 % between step rates.

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

    // Returns true for decisions that are about `every` s apart.
    [[nodiscard]] bool is_due(double every) const { return number % between(every) == 0; }
    // Returns the exact time between two such decisions, s.
    [[nodiscard]] double interval(double every) const { return static_cast<double>(between(every)) * time; }

 private:
    [[nodiscard]] std::uint64_t between(double every) const {
        return static_cast<std::uint64_t>(std::max(1L, std::lround(every / time)));
    }
};

inline constexpr double longest_decision = 0.1;  // s
inline constexpr double longest_whole = 0.118;   // s, of a step that has one part
inline constexpr double longest_motion = 0.06;   // s
// Without bodies and with the response `paper`: at 1.3 m/s 0.65 m a step, within the perception radius of 1 m for
// markers.
inline constexpr double longest_of_points = 0.5;  // s
inline constexpr double rounding = 1e-6;          // of counts, so that 0.1 s at 30 Hz are 3 steps

[[nodiscard]] inline BodyClock body_clock(double dt) {
    BodyClock clock;
    if (dt > longest_whole * (1 + rounding))
        clock.parts = static_cast<int>(std::ceil(dt / longest_decision - rounding));
    const double between = longest_decision / dt + rounding;
    if (clock.parts == 1) clock.steps_between = static_cast<std::uint64_t>(std::max(1.0, between));
    return clock;
}

// Returns the number of motions in a time, s.
[[nodiscard]] inline int motions_in(double time) {
    return std::max(1, static_cast<int>(std::ceil(time / longest_motion - rounding)));
}

}  // namespace wade::crowd
