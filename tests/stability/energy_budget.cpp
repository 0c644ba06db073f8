#include "energy_budget.hpp"

#include <cmath>
#include <limits>

namespace wade::stability {

using fluid::FluidWorld;
using fluid::Kind;
using fluid::Particles;

EnergyBudget::EnergyBudget(const FluidWorld& world)
    : gravity_across_(world.scene().world.gravity * std::cos(std::atan(world.scene().channel.slope))),
      gravity_along_(world.scene().world.gravity * std::sin(std::atan(world.scene().channel.slope))),
      mass_(static_cast<double>(world.particle_mass())),
      last_(sum(world)),
      put_in_(last_.kinetic + last_.potential) {}

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
    if (world.scene().channel.flow == Flow::emitter) note_emitter(world, now);
    if (world.scene().channel.flow == Flow::recirculating && mass > 0) {
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

double EnergyBudget::kinetic_ratio() const {
    if (put_in_ > 0) return last_.kinetic / put_in_;
    return last_.kinetic > 0 ? std::numeric_limits<double>::infinity() : 0;
}

}  // namespace wade::stability
