#pragma once
// How many fluid particles a scene needs.

#include <cstdint>

#include "configs/scene.hpp"

namespace wade {

// Number of particles that fill the channel: length * width * depth / d^3, rounded.
[[nodiscard]] std::uint64_t river_particles(const Scene& scene);

// Smallest fluid.max_particles with which the scene can run.
//   emitter        the filled channel and 5 d more of length for the inflow and the outflow
//   recirculating  the filled channel
//   closed         the sum over the water blocks, each volume / d^3, rounded
[[nodiscard]] std::uint64_t particles_needed(const Scene& scene);

}  // namespace wade
