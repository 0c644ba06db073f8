#pragma once
// How many frames a scene lasts; both programs must agree on it.

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "configs/scene.hpp"

namespace wade {

// Frames of the whole run: duration * frame rate, rounded, at least 1.
[[nodiscard]] inline std::uint64_t frames_of(const Scene& scene) {
    return static_cast<std::uint64_t>(std::max(1LL, std::llround(scene.duration * scene.frame_rate)));
}

}  // namespace wade
