#pragma once
// What a crowd will take, known before anything is taken.

#include "configs/scene/scene.hpp"

namespace wade::crowd {

// Of a process that holds no crowd yet, bytes.
inline constexpr double empty_client = 11e6;

// Of a crowd and its step, to a factor of 2, bytes: fixed markers, agents, fields of travel times, the water near people.
[[nodiscard]] double memory_of_crowd(const Scene& scene);

}  // namespace wade::crowd
