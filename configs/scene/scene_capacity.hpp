#pragma once
// How far fluid particles reach, how deep water is, and how many particles a scene needs.

#include <cstdint>

#include "configs/scene/interval.hpp"
#include "configs/scene/scene.hpp"

namespace wade {

// h / d: of the cubic spline as the scene says, 2 if it says nothing; 2.4 of the quartic spline, 3 of Wendland's C2.
[[nodiscard]] double support_in_spacings_of(const Fluid& fluid);

// Returns h, the support radius of the kernel, m.
[[nodiscard]] double support_radius_of(const Fluid& fluid);

// Returns the length next to emitters and periodic borders that must have a level bed and no obstacles (twice as long
// for obstacles at an emitter), m: the support radius, in shallow water the cell size if that is less.
[[nodiscard]] double reach_of_water(const Fluid& fluid);

// Returns the greatest water height in the scene's keys, m: the scale of wave speeds and of the grid.
[[nodiscard]] double deepest_water(const Scene& scene);

// From the lowest to the highest ground of a site, m.
[[nodiscard]] Interval heights_of_ground(const Scene& scene);

// Number of particles that fill the channel: length * width * depth / d^3, rounded.
[[nodiscard]] std::uint64_t river_particles(const Scene& scene);

// Returns the smallest fluid.max_particles that the scene needs to run.
//   emitter        the filled channel, and its length more by a support radius and 3 d for the inflow and the outflow
//   recirculating  the filled channel
//   periodic       the filled channel, or as closed
//   closed         the sum over the water blocks, each volume / d^3, rounded
//   on a site      the standing water at t = 0; water from sources needs further capacity
[[nodiscard]] std::uint64_t particles_needed(const Scene& scene);

// Returns the largest number of particles to expect: particles_needed() plus the particles from the sources of a site
// during the run, at most fluid.max_particles.
[[nodiscard]] std::uint64_t particles_expected(const Scene& scene);

}  // namespace wade
