#pragma once
// How far fluid particles reach, how deep water is, and how many particles a scene needs.

#include <cstdint>

#include "configs/scene/interval.hpp"
#include "configs/scene/scene.hpp"

namespace wade {

// h / d: of the cubic spline as the scene says, 2 if it says nothing; 2.4 of the quartic spline, 3 of Wendland's C2.
[[nodiscard]] double support_in_spacings_of(const Fluid& fluid);

// h, the distance at which the kernel ends, m.
[[nodiscard]] double support_radius_of(const Fluid& fluid);

// Returns how far obstacles and bed stay level or away from inflows and periodic borders, m: the support radius, in shallow water
// a cell if that is less.
[[nodiscard]] double reach_of_water(const Fluid& fluid);

// The greatest height of water that the scene speaks of, m: sets the scale of wave speeds and of the grid.
[[nodiscard]] double deepest_water(const Scene& scene);

// From the lowest to the highest ground of a site, m.
[[nodiscard]] Interval heights_of_ground(const Scene& scene);

// Number of particles that fill the channel: length * width * depth / d^3, rounded.
[[nodiscard]] std::uint64_t river_particles(const Scene& scene);

// Smallest fluid.max_particles with which the scene can run.
//   emitter        the filled channel, and its length more by a support radius and 3 d for the inflow and the outflow
//   recirculating  the filled channel
//   periodic       the filled channel, or as closed
//   closed         the sum over the water blocks, each volume / d^3, rounded
//   on a site     the water that stands on it at t = 0; what sources bring needs room of its own
[[nodiscard]] std::uint64_t particles_needed(const Scene& scene);

// How many particles there will be at most, as far as the scene tells: those that its channel takes, no more than
// fluid.max_particles.
[[nodiscard]] std::uint64_t particles_expected(const Scene& scene);

}  // namespace wade
