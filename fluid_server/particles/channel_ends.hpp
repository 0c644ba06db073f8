#pragma once
// What the solved water meets at the ends of its channel along x. A world asks it in each step, in this order:
//
//   begin_step             before neighbours are looked for: what comes in, and how fast
//   take_out               how many particles were dropped, which had gone beyond outflow_x()
//   driving_acceleration   with the other forces
//   end_step               at the new places
//
// As it stands nothing happens there: the ends of a closed channel, or one end that is the other.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>

#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

// What an emitter remembers from step to step.
struct EmitterState {
    double last_layer_x = 0;  // m, of the rearmost layer
    std::uint64_t stock = 0;
    std::uint64_t recycled = 0;
    std::uint64_t layers_missed = 0;
};

class ChannelEnds {
 public:
    ChannelEnds() = default;
    ChannelEnds(const ChannelEnds&) = delete;
    ChannelEnds& operator=(const ChannelEnds&) = delete;
    virtual ~ChannelEnds() = default;

    // Before a step of dt, s, from `time`, s: may add and remove particles, says which are Kind::inflow and what velocity
    // those have.
    virtual void begin_step(Particles& /*particles*/, double /*time*/, double /*dt*/) {}

    virtual void take_out(std::size_t /*particles*/) {}

    // Along x, towards -x, of all fluid in a step of dt, s, to the time `end`, s, beside gravity, m/s^2; none: nothing drives it.
    [[nodiscard]] virtual std::optional<double> driving_acceleration(const Particles& /*particles*/, double /*end*/,
                                                                     double /*dt*/) const {
        return std::nullopt;
    }

    // After a step of dt, s. x_before: of each particle at its begin, m
    virtual void end_step(Particles& /*particles*/, std::span<const float> /*x_before*/, double /*dt*/) {}

    // Particles that are not above it have left, m.
    [[nodiscard]] virtual float outflow_x() const { return -std::numeric_limits<float>::infinity(); }

    // Water from inside does not pass it upstream, m.
    [[nodiscard]] virtual float opening_x() const { return std::numeric_limits<float>::infinity(); }

    // Whether Kind::inflow is carried by other water, which gives it velocity and pressure, or waits as a lattice.
    [[nodiscard]] virtual bool carry_inflow() const { return false; }

    // What a user should know at the end of a run; empty if there is nothing.
    [[nodiscard]] virtual std::string remark() const { return {}; }

    [[nodiscard]] virtual std::optional<EmitterState> state() const { return std::nullopt; }
    // Goes on from a state at `time`, s. Only for ends that have one.
    virtual void restore(const EmitterState& /*state*/, Particles& /*particles*/, double /*time*/) {}
};

// Returns the largest velocity along x, at most vx, that keeps a particle at x from passing an opening within dt.
[[nodiscard]] inline float held_by_opening(float opening_x, float x, float vx, float dt) {
    if (opening_x == std::numeric_limits<float>::infinity()) return vx;
    return std::min(vx, std::max(opening_x - x, 0.0F) / dt);
}

}  // namespace wade::fluid
