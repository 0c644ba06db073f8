#pragma once
// Runs water and watches it: finite, inside its solids, complete, not compressed, not faster than its energy allows.

#include <cstdint>
#include <functional>
#include <vector>

#include "fluid_server/dfsph/fluid_world.hpp"
#include "stability_case.hpp"

namespace wade::stability {

// What a case adds to a run.
struct Hooks {
    // Before the first step, for a start that no scene file can describe.
    std::function<void(fluid::FluidWorld&)> start;
    // Before each frame, at the time of its begin: may change the water; returns the energy that this put in, J.
    std::function<double(fluid::FluidWorld&, double)> before_frame;
    // After each step; changes nothing of the water.
    std::function<void(const fluid::FluidWorld&, const fluid::StepReport&, Result&)> after_step;
    // After each frame, at the time given.
    std::function<void(const fluid::FluidWorld&, double, Result&)> after_frame;
    // Compression counts from this time on, s: for a start that is compressed by design.
    double settling = 0;
    // Energy put in at the start beyond the kinetic and potential one of the particles, J.
    double extra_energy = 0;
    // The run ends with this step at the latest; 0 = with the scene's duration. See step_limit() in the source for the
    // number of steps that counts as a failure.
    std::size_t steps = 0;
};

// A run that is given up is a result too: `failure` says why.
Result run_water(const Scene& scene, const Hooks& hooks = {});

// Continues the hash `seed` over the bits of positions and velocities (FNV-1a on 32-bit words).
[[nodiscard]] std::uint64_t hash_state(const fluid::Particles& particles, std::uint64_t seed);

}  // namespace wade::stability
