#pragma once
// What is no water any more. All throw RunError (numerical_failure), with advice on the settings of the fluid.

#include <cstdint>

#include "configs/scene/scene.hpp"
#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

// fastest: of what moves, m/s; expected: of what the scene speaks of, m/s, 0 = nothing.
void check_speed(const Particles& particles, double fastest, double expected, const Fluid& fluid);

// A mean density error, a fraction of rest density.
void check_compression(double mean_error, const Fluid& fluid);

// After a step: particles that are somewhere no longer finite, and the longest way, m.
void check_moves(std::uint64_t not_finite, double longest, double support_radius, const Fluid& fluid);

}  // namespace wade::fluid
