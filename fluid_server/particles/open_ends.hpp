#pragma once
// Ends of the solved water beyond which there is other water: the world asks them in each step.

#include <span>

#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

class OpenEnds {
 public:
    OpenEnds() = default;
    OpenEnds(const OpenEnds&) = delete;
    OpenEnds& operator=(const OpenEnds&) = delete;
    virtual ~OpenEnds() = default;

    // Before a step of dt, s: adds and removes particles, says which are Kind::inflow and what velocity those have.
    virtual void begin_step(Particles& particles, double dt) = 0;

    // After it. x_before: of each particle at the begin of the step, m
    virtual void end_step(const Particles& particles, std::span<const float> x_before, double dt) = 0;

    // Along x, of all fluid in the step at hand, beside gravity, m/s^2.
    [[nodiscard]] virtual double acceleration() const = 0;
};

}  // namespace wade::fluid
