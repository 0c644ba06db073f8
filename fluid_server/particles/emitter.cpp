#include "fluid_server/particles/emitter.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene/particle_volume.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "fluid_server/particles/filling.hpp"
#include "fluid_server/particles/inflow.hpp"
#include "fluid_server/particles/parallel.hpp"

namespace wade::fluid {

namespace {

// Layers that wait behind the opening: as many as the kernel reaches, and one for the way of the lattice between two.
int layers_within_reach(const Fluid& fluid, double pitch) {
    return static_cast<int>(std::ceil(support_radius_of(fluid) / pitch - 1e-6)) + 1;
}

}  // namespace

InflowLayer layer_over(double depth, double width, double spacing) {
    InflowLayer layer{count_along(depth, spacing), count_along(width, spacing)};
    layer.dy = static_cast<float>(depth / layer.ny);
    layer.dz = static_cast<float>(width / layer.nz);
    return layer;
}

Emitter::Emitter(const Scene& scene, std::uint64_t particles_in_use)
    : opening_x_(scene.channel.x.hi),
      velocity_(velocity_at(scene.channel, 0)),
      waiting_layers_(0),
      z_lo_(scene.channel.z.lo),
      layer_(layer_over(scene.channel.depth, scene.channel.z.length(), scene.fluid.particle_spacing)),
      pitch_(),
      last_layer_x_(),
      stock_(static_cast<std::uint64_t>(scene.fluid.max_particles) - particles_in_use) {
    pitch_ = static_cast<double>(layer_.sites()) * particle_volume(scene.fluid) /
             (scene.channel.depth * scene.channel.z.length());
    waiting_layers_ = layers_within_reach(scene.fluid, pitch_);
    last_layer_x_ = opening_x_ - 0.5 * pitch_;
}

void Emitter::set_velocity(Particles& p, double velocity) {
    velocity_ = velocity;
    for_each_particle(p.count, [&](std::size_t i) {
        if (p.kind[i] == Kind::inflow) {
            p.vx[i] = static_cast<float>(-velocity);
        }
    });
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
    while (last_layer_x_ + pitch_ <= opening_x_ + waiting_layers_ * pitch_) {
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

}  // namespace wade::fluid
