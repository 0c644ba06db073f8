// The stages at the end of a step of the water: contact with solids, and the way that particles go.

#include <algorithm>
#include <cmath>
#include <utility>

#include "fluid_server/dfsph/fluid_world.hpp"
#include "fluid_server/dfsph/step_measures.hpp"

namespace wade::fluid {

namespace {

// Adds what contact with an obstacle took from the velocity of a particle within dt.
void add_contact(std::uint32_t obstacle, const Vec3& removed, float dt, std::vector<ContactSum>& sums) {
    auto at = std::find_if(sums.begin(), sums.end(), [&](const ContactSum& s) { return s.obstacle == obstacle; });
    if (at == sums.end()) at = sums.insert(at, ContactSum{obstacle});
    for (std::size_t k = 0; k < 3; ++k) at->change[k] += static_cast<double>(removed[k] / dt);
}

}  // namespace

void apply_acceleration(Particles& p, const ParticleFields& f, float dt) {
    for_each_particle(p.count, [&](std::size_t i) {
        p.vx[i] += dt * f.ax[i];
        p.vy[i] += dt * f.ay[i];
        p.vz[i] += dt * f.az[i];
    });
}

Places FluidWorld::places(std::size_t begin) const {
    return {particles_.x.data() + begin, particles_.y.data() + begin, particles_.z.data() + begin};
}

void FluidWorld::touch_solids(float dt, StepReport& report) {
    Particles& p = particles_;
    const float opening = ends_->opening_x();
    sums_.begin(p.count);
    contact_sums_.begin(p.count);
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        const auto on_obstacle = [&](std::uint32_t o, std::size_t i, const Vec3& removed) {
            if (p.kind[begin + i] == Kind::fluid) add_contact(o, removed, dt, contact_sums_[b]);
        };
        BlockVelocities v;
        for (std::size_t i = begin; i < end; ++i) {
            v.x[i - begin] = p.vx[i], v.y[i - begin] = p.vy[i], v.z[i - begin] = p.vz[i];
        }
        if (site_) {
            site_->apply_contact(places(begin), end - begin, dt, v, on_obstacle);
        } else {
            solids_.apply_contact(places(begin), end - begin, dt, v, on_obstacle);
        }
        double lifted = 0;  // m/s
        for (std::size_t i = begin; i < end; ++i) {
            if (p.kind[i] == Kind::fluid) {
                lifted += static_cast<double>(v.y[i - begin] - p.vy[i]);
                p.vx[i] = held_by_opening(opening, p.x[i], v.x[i - begin], dt);
                p.vy[i] = v.y[i - begin], p.vz[i] = v.z[i - begin];
            }
        }
        sums_[b] = lifted / static_cast<double>(dt);
    });
    const auto mass = static_cast<double>(particle_mass_);
    contact_forces_.assign(site_ ? scene_.site->houses.size() : scene_.obstacles.size(), {});
    for (std::size_t b = 0; b < block_count(particles_.count); ++b) {
        for (const ContactSum& sum : contact_sums_[b]) {
            for (std::size_t k = 0; k < 3; ++k) {
                contact_forces_[sum.obstacle][k] += mass * sum.change[k];
            }
        }
    }
    report.contact_force = mass * sums_.total([](double& sum, double a) { sum += a; });
}

// W11.
void FluidWorld::move(float dt, float shift_time, StepReport& report) {
    Particles& p = particles_;
    const float opening = ends_->opening_x();
    // The lattice of an emitter goes its way.
    const bool inflow_is_carried = ends_->carry_inflow();
    const ParticleFields& f = fields_;
    guards_.begin(p.count);
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        BlockVelocities v;
        for (std::size_t i = begin; i < end; ++i) {
            v.x[i - begin] = p.vx[i] + shift_time * f.ax[i];
            v.y[i - begin] = p.vy[i] + shift_time * f.ay[i];
            v.z[i - begin] = p.vz[i] + shift_time * f.az[i];
        }
        if (shift_time > 0 && site_) {
            site_->apply_contact(places(begin), end - begin, dt, v);
        } else if (shift_time > 0) {
            solids_.apply_contact(places(begin), end - begin, dt, v, [](std::uint32_t, std::size_t, const Vec3&) {});
        }
        Guards guards;
        for (std::size_t i = begin; i < end; ++i) {
            Vec3 u{p.vx[i], p.vy[i], p.vz[i]};
            if (p.kind[i] == Kind::fluid || inflow_is_carried) {
                u = {v.x[i - begin], v.y[i - begin], v.z[i - begin]};
                u[0] = shift_time > 0 ? held_by_opening(opening, p.x[i], u[0], dt) : u[0];
            }
            Vec3 x{grid_.wrap(0, p.x[i] + dt * u[0]), grid_.wrap(1, p.y[i] + dt * u[1]),
                   grid_.wrap(2, p.z[i] + dt * u[2])};
            const float v2 = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
            guards.longest_squared = std::max(guards.longest_squared, dt * dt * v2);
            guards.not_finite += std::isfinite(x[0] + x[1] + x[2]) ? 0U : 1U;
            guards.clamps += (site_ ? site_->clamp(x) : solids_.clamp(x)) ? 1U : 0U;
            lists_.x[i] = x[0], lists_.y[i] = x[1], lists_.z[i] = x[2];
        }
        guards_[b] = guards;
    });
    // The lists keep the places that they were made for.
    std::swap(p.x, lists_.x);
    std::swap(p.y, lists_.y);
    std::swap(p.z, lists_.z);
    const Guards all = guards_.total([](Guards& total, const Guards& block) {
        total.clamps += block.clamps;
        total.not_finite += block.not_finite;
        total.longest_squared = std::max(total.longest_squared, block.longest_squared);
    });
    position_clamps_ += all.clamps;
    report.max_displacement = std::sqrt(static_cast<double>(all.longest_squared));
    check_moves(all.not_finite, report.max_displacement, static_cast<double>(support_radius_), scene_.fluid);
}

}  // namespace wade::fluid
