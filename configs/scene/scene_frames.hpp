#pragma once
// How many frames a scene lasts; both programs must agree on it.

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "configs/scene/crowd.hpp"
#include "configs/scene/scene.hpp"

namespace wade {

// Frames of the whole run: duration * frame rate, rounded, at least 1.
[[nodiscard]] inline std::uint64_t frames_of(const Scene& scene) {
    return static_cast<std::uint64_t>(std::max(1LL, std::llround(scene.duration * scene.frame_rate)));
}

// Steps of the crowd in the whole run.
[[nodiscard]] inline std::uint64_t steps_of(const Scene& scene) {
    return static_cast<std::uint64_t>(std::max(1LL, std::llround(scene.duration * scene.crowd->step_rate)));
}

// Steps of the crowd that are due once the water has reached `tick`: step k is taken at k / step_rate. A millionth of a
// step makes up for rates that are no whole number of ticks.
[[nodiscard]] inline std::uint64_t steps_due(const Scene& scene, std::uint64_t tick, std::uint64_t ticks_per_second) {
    const double time = static_cast<double>(tick) / static_cast<double>(ticks_per_second);
    return static_cast<std::uint64_t>(std::floor(time * scene.crowd->step_rate + 1e-6));
}

// Frame k of files with so many frames a second, at most, is the state after k times so many steps: the least whole number that
// keeps to the rate.
[[nodiscard]] inline std::uint64_t steps_per_frame_at(double step_rate, double rate) {
    return static_cast<std::uint64_t>(std::max(1.0, std::ceil(step_rate / rate - 1e-9)));
}
[[nodiscard]] inline std::uint64_t steps_per_path_frame(const Scene& scene) {
    return steps_per_frame_at(scene.crowd->step_rate, scene.crowd->paths.rate);
}

// The first frame at or after `time`, s; a time that is a frame's up to rounding means this frame.
[[nodiscard]] inline std::uint64_t frame_at(double time, double frame_rate) {
    constexpr double rounding = 1e-6;  // frames
    return static_cast<std::uint64_t>(std::ceil(std::max(0.0, time * frame_rate - rounding)));
}

// Returns the crowd step that starts an event of this water frame: the first step after the frame before.
[[nodiscard]] inline std::uint64_t step_of_frame(const Scene& scene, std::uint64_t frame) {
    if (frame == 0) return 0;
    const double steps_per_frame = scene.crowd->step_rate / scene.frame_rate;
    return static_cast<std::uint64_t>(std::floor(static_cast<double>(frame - 1) * steps_per_frame + 1e-6)) + 1;
}

}  // namespace wade
