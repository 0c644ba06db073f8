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

#include <algorithm>
#include <cstdint>

#include "configs/scene/scene.hpp"
#include "fluid_server/particles/particles.hpp"

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

// What an emitter remembers from step to step.
struct EmitterState {
    double last_layer_x = 0;  // m, of the rearmost layer
    std::uint64_t stock = 0;
    std::uint64_t recycled = 0;
    std::uint64_t layers_missed = 0;
};

class Emitter {
 public:
    Emitter(const Scene& scene, std::uint64_t particles_in_use);

    // Adds the layers that are due behind the opening and turns those that have passed it into fluid.
    // Call it at t = 0 and after each advance by dt; dt = 0 at the start.
    void emit(Particles& particles, float dt);

    // v_F from now on, m/s >= 0, for the whole lattice: a step's mean, so that the way of the lattice, and with it the mass
    // that passes the opening, is the integral of v_F.
    void set_velocity(Particles& particles, double velocity);

    // Particles that left through the outflow go back to the stock.
    void recycle(std::uint64_t particles) {
        stock_ += particles;
        recycled_ += particles;
    }

    // The opening is closed to water from inside: the velocity along x, at most vx, with which a fluid particle at x does
    // not pass it within dt.
    [[nodiscard]] float limit(float x, float vx, float dt) const {
        return std::min(vx, std::max(static_cast<float>(opening_x_) - x, 0.0F) / dt);
    }

    [[nodiscard]] std::uint64_t stock() const { return stock_; }
    [[nodiscard]] std::uint64_t recycled() const { return recycled_; }
    [[nodiscard]] std::uint64_t layers_missed() const { return layers_missed_; }
    [[nodiscard]] EmitterState state() const { return {last_layer_x_, stock_, recycled_, layers_missed_}; }
    void restore(const EmitterState& state);

 private:
    double opening_x_;
    double velocity_;
    int waiting_layers_;
    double z_lo_;
    InflowLayer layer_;
    double pitch_;         // distance of layers, so that the mass flow is exactly rho v_F depth width
    double last_layer_x_;  // where the rearmost layer is
    std::uint64_t stock_;
    std::uint64_t recycled_ = 0;
    std::uint64_t layers_missed_ = 0;
};

}  // namespace wade::fluid
