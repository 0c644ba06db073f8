#pragma once
// Estimates the memory of a crowd before any is allocated.

#include "configs/scene/scene.hpp"

namespace wade::crowd {

// Memory of a process without a crowd, bytes.
inline constexpr double empty_client = 11e6;

// Returns the memory of a crowd and its step, to a factor of 2, bytes: fixed markers, agents, travel-time fields, the
// water near agents.
[[nodiscard]] double memory_of_crowd(const Scene& scene);

}  // namespace wade::crowd
