#include "fluid_server/particles/emitter.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene/fluid.hpp"
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
    : channel_(scene.channel),
      velocity_(velocity_at(channel_, 0)),
      waiting_layers_(0),
      layer_(layer_over(channel_.depth, channel_.z.length(), scene.fluid->particle_spacing)),
      pitch_(static_cast<double>(layer_.sites()) * particle_volume(scene.fluid) /
             (channel_.depth * channel_.z.length())) {
    waiting_layers_ = layers_within_reach(scene.fluid, pitch_);
    state_.last_layer_x = channel_.x.hi - 0.5 * pitch_;
    state_.stock = static_cast<std::uint64_t>(scene.fluid->max_particles) - particles_in_use;
}

void Emitter::begin_step(Particles& particles, double time, double dt) {
    if (!channel_.velocity_history.empty()) set_velocity(particles, mean_velocity(channel_, time, time + dt));
}

void Emitter::take_out(std::size_t particles) {
    state_.stock += particles;
    state_.recycled += particles;
}

void Emitter::end_step(Particles& particles, std::span<const float>, double dt) {
    emit(particles, static_cast<float>(dt));
}

void Emitter::restore(const EmitterState& state, Particles& particles, double time) {
    state_ = state;
    set_velocity(particles, velocity_at(channel_, time));
}

void Emitter::set_velocity(Particles& p, double velocity) {
    velocity_ = velocity;
    for_each_particle(p.count, [&](std::size_t i) {
        if (p.kind[i] == Kind::inflow) {
            p.vx[i] = static_cast<float>(-velocity);
        }
    });
}

void Emitter::emit(Particles& p, float dt) {
    double& last = state_.last_layer_x;
    last -= velocity_ * static_cast<double>(dt);
    const float opening = opening_x();
    for (std::size_t i = 0; i < p.count; ++i) {
        if (p.kind[i] == Kind::inflow && p.x[i] <= opening) {
            p.kind[i] = Kind::fluid;
        }
    }
    while (last + pitch_ <= channel_.x.hi + waiting_layers_ * pitch_) {
        last += pitch_;
        if (state_.stock < layer_.sites()) {
            ++state_.layers_missed;
            continue;
        }
        state_.stock -= layer_.sites();
        for (int k = 0; k < layer_.nz; ++k) {
            for (int j = 0; j < layer_.ny; ++j) {
                p.add({static_cast<float>(last), (static_cast<float>(j) + 0.5F) * layer_.dy,
                       static_cast<float>(channel_.z.lo) + (static_cast<float>(k) + 0.5F) * layer_.dz},
                      {static_cast<float>(-velocity_), 0, 0}, Kind::inflow);
            }
        }
    }
}

}  // namespace wade::fluid
