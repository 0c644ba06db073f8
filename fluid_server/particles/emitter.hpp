#pragma once
// The rectangular emitter at the upstream end and the stock that feeds it.
//
//      x.hi        x.hi + layers * pitch
//   ~~~~|. . . . . .|        Layers of particles wait behind the opening x.hi as a lattice that moves with the velocity
//   <-- |. . . . . .| v_F    of the emitter. A particle that passes the opening becomes fluid; a new layer joins at the
//   ~~~~|. . . . . .|        back whenever the lattice has moved by one pitch, as long as the stock lasts.
//
// The lattice reaches further back than the support radius, so that no row is missing behind the opening. With v_F = 0 it
// stands still and closes the opening.

#include <cstdint>

#include "configs/scene/channel.hpp"
#include "configs/scene/scene.hpp"
#include "fluid_server/particles/channel_ends.hpp"

namespace wade::fluid {

// The sites of one layer: rows and columns over the opening, as near to square as it allows.
struct InflowLayer {
    int ny = 0, nz = 0;
    float dy = 0, dz = 0;  // m
    [[nodiscard]] std::uint64_t sites() const {
        return static_cast<std::uint64_t>(ny) * static_cast<std::uint64_t>(nz);
    }
};
InflowLayer layer_over(double depth, double width, double spacing);

class Emitter final : public ChannelEnds {
 public:
    Emitter(const Scene& scene, std::uint64_t particles_in_use);

    // Adds the layers that are due behind the opening and turns those that have passed it into fluid.
    // Call it at t = 0 and after each advance by dt; dt = 0 at the start.
    void emit(Particles& particles, float dt);

    // v_F from now on, m/s >= 0, for the whole lattice: a step's mean, so that the way of the lattice, and with it the mass
    // that passes the opening, is the integral of v_F.
    void set_velocity(Particles& particles, double velocity);

    void begin_step(Particles& particles, double time, double dt) override;
    // Particles that left through the outflow go back to the stock.
    void take_out(std::size_t particles) override;
    void end_step(Particles& particles, std::span<const float> x_before, double dt) override;
    [[nodiscard]] float outflow_x() const override { return static_cast<float>(channel_.x.lo); }
    [[nodiscard]] float opening_x() const override { return static_cast<float>(channel_.x.hi); }
    [[nodiscard]] std::optional<EmitterState> state() const override { return state_; }
    void restore(const EmitterState& state, Particles& particles, double time) override;

 private:
    Channel channel_;
    double velocity_;
    int waiting_layers_;
    InflowLayer layer_;
    double pitch_;  // distance of layers, so that the mass flow is exactly rho v_F depth width
    EmitterState state_;
};

}  // namespace wade::fluid
