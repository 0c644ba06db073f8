#include "fluid_server/emitter.hpp"

#include <algorithm>
#include <cmath>

namespace wade::fluid {

namespace {

// Layers that wait behind the opening: the kernel reaches two spacings, and a row must not be missing behind the first.
constexpr int waiting_layers = 3;

}  // namespace

Emitter::Emitter(const Scene& scene, std::uint64_t particles_in_use)
    : opening_x_(scene.channel.x.hi),
      velocity_(scene.channel.velocity),
      z_lo_(scene.channel.z.lo),
      layer_(lattice_over(0, scene.channel.depth, scene.channel.z.length(), scene.fluid.particle_spacing, 0)),
      pitch_(),
      last_layer_x_(),
      stock_(static_cast<std::uint64_t>(scene.fluid.max_particles) - particles_in_use) {
    const double d = scene.fluid.particle_spacing;
    pitch_ = static_cast<double>(layer_.sites()) * d * d * d / (scene.channel.depth * scene.channel.z.length());
    last_layer_x_ = opening_x_ - 0.5 * pitch_;
}

void Emitter::restore(const EmitterState& state) {
    last_layer_x_ = state.last_layer_x;
    stock_ = state.stock;
    recycled_ = state.recycled;
    layers_missed_ = state.layers_missed;
}

void Emitter::emit(Particles& p, float dt) {
    last_layer_x_ -= velocity_ * static_cast<double>(dt);
    const auto opening = static_cast<float>(opening_x_);
    for (std::size_t i = 0; i < p.count; ++i) {
        if (p.kind[i] == Kind::inflow && p.x[i] <= opening) {
            p.kind[i] = Kind::fluid;
        }
    }
    while (last_layer_x_ + pitch_ <= opening_x_ + waiting_layers * pitch_) {
        last_layer_x_ += pitch_;
        if (stock_ < layer_.sites()) {
            ++layers_missed_;
            continue;
        }
        stock_ -= layer_.sites();
        for (int k = 0; k < layer_.nz; ++k) {
            for (int j = 0; j < layer_.ny; ++j) {
                p.add({static_cast<float>(last_layer_x_), (static_cast<float>(j) + 0.5F) * layer_.dy,
                       static_cast<float>(z_lo_) + (static_cast<float>(k) + 0.5F) * layer_.dz},
                      {static_cast<float>(-velocity_), 0, 0}, Kind::inflow);
            }
        }
    }
}

void Emitter::apply_contact(Particles& p, float dt) const {
    const auto opening = static_cast<float>(opening_x_);
    for (std::size_t i = 0; i < p.count; ++i) {
        if (p.kind[i] == Kind::fluid) {
            p.vx[i] = std::min(p.vx[i], std::max(opening - p.x[i], 0.0F) / dt);
        }
    }
}

}  // namespace wade::fluid
