#pragma once
// What a run of a scene will take, known before anything is taken. Rough: memory to a factor of 2,
// time of a stream to about 2, of water that falls and splashes to about 5.

#include <cstdint>
#include <string>

#include "configs/scene/scene.hpp"

namespace wade::fluid {

struct Estimate {
    std::uint64_t particles = 0;  // in a frame, at most
    double memory = 0;            // of the server: its own, and the frames that it shares, bytes
    double cpu_time = 0;          // of the water of the whole run, s on one core of a usual machine
};

// Of a process that holds no water yet, bytes.
inline constexpr double empty_server = 6.5e6;

// Of the frames in shared memory, for a model of this capacity, bytes.
[[nodiscard]] double memory_of_frames(const Scene& scene, std::uint64_t capacity);

// Neighbours within a radius, m, of a particle in the middle of the water.
[[nodiscard]] double neighbours_within(double radius, const Fluid& fluid);

// "at most 27619 particles, 40 MB of memory, about 3 min of CPU time"
[[nodiscard]] std::string text_of(const Estimate& estimate);

}  // namespace wade::fluid
