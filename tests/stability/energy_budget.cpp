#include "energy_budget.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"

namespace wade::stability {

using fluid::FluidWorld;
using fluid::Kind;
using fluid::Particles;

namespace {

double solid_height(const Scene& scene, double x, double z) {
    double height = bed_height(scene.channel, x);
    for (const Obstacle& o : scene.obstacles) {
        if (x > o.x.lo && x < o.x.hi && z > o.z.lo && z < o.z.hi) height = std::max(height, o.height);
    }
    return height;
}

double gravity_across(const Scene& scene) {
    return scene.world->gravity * std::cos(std::atan(scene.channel->slope));
}

}  // namespace

double bed_height(const Channel& channel, double x) {
    const std::vector<BedPoint>& bed = channel.bed_points;
    if (bed.empty()) return 0;
    if (x <= bed.front().x) return bed.front().y;
    for (std::size_t k = 1; k < bed.size(); ++k) {
        if (x > bed[k].x) continue;
        const double share = (x - bed[k - 1].x) / (bed[k].x - bed[k - 1].x);
        return bed[k - 1].y + share * (bed[k].y - bed[k - 1].y);
    }
    return bed.back().y;
}

double level_pool_energy(const Scene& scene, double volume) {
    const Interval& x = scene.channel->x;
    const Interval& z = scene.channel->z;
    const double cell = 0.5 * scene.fluid->particle_spacing;
    const auto nx = static_cast<std::size_t>(std::max(1.0, std::ceil(x.length() / cell)));
    const auto nz = static_cast<std::size_t>(std::max(1.0, std::ceil(z.length() / cell)));
    std::vector<double> ground;
    ground.reserve(nx * nz);
    for (std::size_t i = 0; i < nx; ++i) {
        for (std::size_t k = 0; k < nz; ++k) {
            ground.push_back(
                solid_height(scene, x.lo + (static_cast<double>(i) + 0.5) / static_cast<double>(nx) * x.length(),
                             z.lo + (static_cast<double>(k) + 0.5) / static_cast<double>(nz) * z.length()));
        }
    }
    std::sort(ground.begin(), ground.end());
    const double area = x.length() * z.length() / static_cast<double>(ground.size());
    // The level L over the n lowest points: n L - sum of their heights = volume / area, L not above the next point.
    double sum = 0;
    double squares = 0;
    double level = 0;
    std::size_t n = 0;
    do {
        sum += ground[n];
        squares += ground[n] * ground[n];
        ++n;
        level = (volume / area + sum) / static_cast<double>(n);
    } while (n < ground.size() && level > ground[n]);
    return scene.fluid->rest_density * gravity_across(scene) * area *
           (static_cast<double>(n) * level * level - squares) / 2;
}

EnergyBudget::EnergyBudget(const FluidWorld& world)
    : gravity_across_(gravity_across(world.scene())),
      gravity_along_(world.scene().world->gravity * std::sin(std::atan(world.scene().channel->slope))),
      mass_(static_cast<double>(world.particle_mass())),
      last_(sum(world)),
      put_in_(last_.kinetic + last_.potential) {
    const Scene& scene = world.scene();
    if (scene.channel->flow != Flow::closed) return;
    resting_ = level_pool_energy(scene, last_.count * mass_ / scene.fluid->rest_density);
    const double area = scene.channel->x.length() * scene.channel->z.length();
    const double d = scene.fluid->particle_spacing;
    surface_energy_ = scene.fluid->rest_density * gravity_across_ * area * d * d / 8;
}

EnergyBudget::Sums EnergyBudget::sum(const FluidWorld& world) const {
    const Particles& p = world.particles();
    const Channel& channel = world.scene().channel;
    const double outflow = channel.flow == Flow::emitter ? channel.x.lo : -std::numeric_limits<double>::infinity();
    Sums sums;
    for (std::size_t i = 0; i < p.count; ++i) {
        const double vx = static_cast<double>(p.vx[i]);
        const double vy = static_cast<double>(p.vy[i]);
        const double vz = static_cast<double>(p.vz[i]);
        if (p.kind[i] == Kind::inflow) {
            sums.inflow_velocity = -vx;
            continue;
        }
        const double kinetic = 0.5 * mass_ * (vx * vx + vy * vy + vz * vz);
        const double potential = mass_ * gravity_across_ * static_cast<double>(p.y[i]);
        sums.count += 1;
        sums.kinetic += kinetic;
        sums.potential += potential;
        sums.momentum += mass_ * vx;
        if (static_cast<double>(p.x[i]) <= outflow) {
            sums.leaving += kinetic + potential;
            sums.leaving_momentum += mass_ * vx;
            sums.leaving_count += 1;
        }
    }
    return sums;
}

void EnergyBudget::note_emitter(const FluidWorld& world, const Sums& now) {
    const Channel& channel = world.scene().channel;
    const double v = now.inflow_velocity;
    const double passed = now.count - (last_.count - last_.leaving_count);
    const double force_impulse = (last_.momentum - last_.leaving_momentum) - (now.momentum + passed * mass_ * v);
    put_in_ += passed * mass_ * (0.5 * v * v + 0.5 * gravity_across_ * channel.depth);
    put_in_ += force_impulse * v;
}

void EnergyBudget::note_step(const FluidWorld& world, const fluid::StepReport& step) {
    const Sums now = sum(world);
    const double mass = now.count * mass_;
    carried_out_ += last_.leaving;
    if (world.scene().channel->flow == Flow::emitter) note_emitter(world, now);
    if (world.scene().channel->flow == Flow::recirculating && mass > 0) {
        const double push = step.driving_acceleration * step.dt;
        // The push ends at the speed that the scene asks for; obstacles change it afterwards.
        const Channel& channel = world.scene().channel;
        const double bulk = channel.velocity_history.empty() ? channel.velocity - push : -last_.momentum / mass;
        put_in_ += mass * push * (bulk + push / 2);
    }
    put_in_ -= gravity_along_ * step.dt * 0.5 * (last_.momentum - last_.leaving_momentum + now.momentum);
    last_ = now;
}

double EnergyBudget::ratio() const {
    const double energy = last_.kinetic + last_.potential + carried_out_;
    if (put_in_ > 0) return energy / put_in_;
    return energy > 0 ? std::numeric_limits<double>::infinity() : 0;
}

double EnergyBudget::convertible() const {
    return std::max(put_in_ - resting_, surface_energy_);
}

double EnergyBudget::kinetic_ratio() const {
    if (convertible() > 0) return last_.kinetic / convertible();
    return last_.kinetic > 0 ? std::numeric_limits<double>::infinity() : 0;
}

}  // namespace wade::stability
