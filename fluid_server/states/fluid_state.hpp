#pragma once
// The complete state of the solved water between two frames: all that the next step depends on besides the scene. A
// world that is given it goes on with the same bits as the one it was taken from.

#include <cstdint>
#include <optional>
#include <string>

#include "configs/scene/scene.hpp"
#include "fluid_server/particles/channel_ends.hpp"
#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

struct FluidState {
    Scene scene;              // of the run that it was taken from
    double time = 0;          // s, since the water's t = 0
    std::uint64_t frame = 0;  // frames since then
    std::uint64_t position_clamps = 0;
    std::optional<EmitterState> emitter;
    Particles particles{0};  // in the order of the run
};

// Replaces the living particles of `to` by those of `from`: 33 bytes a particle, no allocation if the capacity is
// enough. Throws std::length_error if it is not.
void copy_particles(const Particles& from, Particles& to);

// Throws ConfigurationError, beginning with `source`, unless water of the state can go on in this scene: the same
// model, spacing, kernel, rest density, channel, emitter opening and obstacles, ground, houses and gates of a site, and
// room for the particles and for the stock that must remain of max_particles. Everything else may differ: solver
// settings, viscosity, duration, the crowd.
void check_state_fits(const FluidState& state, const Scene& scene, const std::string& source);

}  // namespace wade::fluid
