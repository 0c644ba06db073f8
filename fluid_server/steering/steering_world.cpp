#include "fluid_server/steering/steering_world.hpp"

#include <algorithm>
#include <cmath>

#include "configs/checks/scene_checks.hpp"
#include "configs/errors/exit_code.hpp"
#include "configs/numbers/splitmix.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/particle_volume.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "configs/scene/steering.hpp"
#include "configs/scene/world.hpp"
#include "fluid_server/particles/body_force.hpp"
#include "fluid_server/particles/filling.hpp"
#include "fluid_server/particles/make_channel_ends.hpp"

namespace wade::fluid::steering {

namespace {

// The margin of the lists, in spacings: wider lists serve longer and cost more in each step.
constexpr double margin_in_spacings = 0.3;

// Returns the scene without solids, so that no particle sees a mirror image.
Scene without_solids(Scene scene) {
    scene.channel->flow = Flow::periodic;
    scene.channel->sides = Sides::periodic;
    scene.channel->top = Top::periodic;
    scene.channel->bed_points.clear();
    scene.channel->no_slip.clear();
    scene.obstacles.clear();
    return scene;
}

}  // namespace

SteeringWorld::SteeringWorld(const Scene& scene)
    : scene_(scene),
      settings_(make_settings(scene)),
      margin_(margin_in_spacings * scene.fluid->particle_spacing),
      particle_mass_(wade::particle_mass(scene.fluid)),
      particles_(static_cast<std::size_t>(scene.fluid->max_particles)),
      grid_(scene, static_cast<float>(settings_.reach + margin_)),
      lists_(particles_.capacity()),
      solids_(scene),
      no_solids_(without_solids(scene)),
      walls_(solids_, scene.channel, settings_),
      bed_(bed_facets(scene.channel)),
      bodies_(make_bodies(scene, settings_)),
      ax_(padded(particles_.capacity())),
      ay_(padded(particles_.capacity())),
      az_(padded(particles_.capacity())),
      gravity_x_(-scene.world->gravity * std::sin(std::atan(scene.channel->slope))),
      gravity_y_(-scene.world->gravity * std::cos(std::atan(scene.channel->slope))) {
    const Channel& channel = scene.channel;
    if (channel.flow == Flow::recirculating || channel.flow == Flow::periodic) {
        period_[0] = static_cast<float>(channel.x.length());
    }
    if (channel.top == Top::periodic) period_[1] = static_cast<float>(channel.height);
    if (channel.sides == Sides::periodic) period_[2] = static_cast<float>(channel.z.length());
    fill_scene(particles_, scene);
    ends_ = make_channel_ends(scene, particles_);
    set_classes(0);
}

void SteeringWorld::set_classes(std::size_t begin) {
    const std::uint64_t key = mix_bits(scene_.seed + splitmix_step);
    for (std::size_t i = begin; i < particles_.count; ++i) {
        const double u = unit_fraction(mix_bits(key + born_++ * splitmix_step));
        float radius = 1;
        float mass = 1;
        double below = 0;
        for (const SteeringClass& c : scene_.fluid->steering.classes) {
            if (u >= below && u < below + c.share) {
                radius = static_cast<float>(c.radius);
                mass = static_cast<float>(c.mass);
            }
            below += c.share;
        }
        radius_factors(particles_)[i] = radius;
        mass_factors(particles_)[i] = mass;
    }
}

double SteeringWorld::time_step(double remaining) {
    const Particles& p = particles_;
    fastest_.begin(p.count);
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        float fastest = 0;
        for (std::size_t i = begin; i < end; ++i) {
            fastest = std::max(fastest, p.vx[i] * p.vx[i] + p.vy[i] * p.vy[i] + p.vz[i] * p.vz[i]);
        }
        fastest_[b] = fastest;
    });
    double v = std::sqrt(
        static_cast<double>(fastest_.total([](float& total, float block) { total = std::max(total, block); })));
    for (const Body& body : bodies_) {
        if (body.present) v = std::max(v, behaviours::length(body.vehicle.velocity));
    }
    const double speed = v + settings_.wave_speed;
    const double d = settings_.spacing;
    const double dt = speed > 0 ? std::min(scene_.fluid->cfl * d / speed, settings_.loss_limit) : remaining;
    return remaining / std::ceil(remaining / dt);
}

void SteeringWorld::make_lists() {
    Particles& p = particles_;
    for_each_particle(p.count, [&](std::size_t i) {
        p.x[i] = grid_.wrap(0, p.x[i]), p.y[i] = grid_.wrap(1, p.y[i]), p.z[i] = grid_.wrap(2, p.z[i]);
    });
    ends_->take_out(grid_.sort(p, ends_->outflow_x()));
    find_neighbours(grid_, no_solids_, p, static_cast<float>(settings_.reach + margin_), lists_);
    const auto n = static_cast<std::ptrdiff_t>(p.count);
    std::copy_n(p.x.begin(), n, lists_.x.begin());
    std::copy_n(p.y.begin(), n, lists_.y.begin());
    std::copy_n(p.z.begin(), n, lists_.z.begin());
    lists_serve_ = true;
}

SteeringStep SteeringWorld::step(double remaining) {
    SteeringStep report;
    report.dt = time_step(remaining);
    const auto dt = static_cast<float>(report.dt);
    report.new_lists = !lists_serve_;
    if (!lists_serve_) make_lists();
    ends_->begin_step(particles_, time_, report.dt);
    accelerate(dt);
    drive(report);
    push_by_bodies(dt);
    advance(dt, report);
    move_bodies(report.dt);
    let_in(report.dt);
    time_ += report.dt;
    return report;
}

void SteeringWorld::accelerate(float dt) {
    Particles& p = particles_;
    const std::vector<float>& mass = mass_factors(p);
    const auto gx = static_cast<float>(gravity_x_), gy = static_cast<float>(gravity_y_);
    // All forces use the same velocities, before any velocity changes.
    for_each_block(p.count, [&](std::size_t, std::size_t, std::size_t b) {
        sum_flock(b, p, lists_, settings_, {ax_.data(), ay_.data(), az_.data()});
    });
    for_each_particle(p.count, [&](std::size_t i) {
        if (p.kind[i] != Kind::fluid) return;
        Vec3 v{p.vx[i], p.vy[i], p.vz[i]};
        Vec3 by_walls{};
        walls_.add_acceleration({p.x[i], p.y[i], p.z[i]}, v, by_walls);
        const float per_mass = 1 / mass[i];
        Vec3 a{ax_[i] + per_mass * by_walls[0], ay_[i] + per_mass * by_walls[1], az_[i] + per_mass * by_walls[2]};
        const float most = settings_.max_acceleration * per_mass;
        const float a2 = a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
        const float share = a2 > most * most ? most / std::sqrt(a2) : 1.0F;
        p.vx[i] = v[0] + dt * (share * a[0] + gx);
        p.vy[i] = v[1] + dt * (share * a[1] + gy);
        p.vz[i] = v[2] + dt * (share * a[2]);
    });
}

void SteeringWorld::drive(SteeringStep& report) {
    const auto driving = ends_->driving_acceleration(particles_, time_ + report.dt, report.dt);
    if (!driving) return;
    report.driving_acceleration = *driving;
    apply_body_force(particles_, static_cast<float>(-*driving), 0, static_cast<float>(report.dt));
}

void SteeringWorld::let_in(double dt) {
    const std::size_t before = particles_.count;
    ends_->end_step(particles_, {lists_.x.data(), before}, dt);
    set_classes(before);
    lists_serve_ = lists_serve_ && particles_.count == before;
}

Vec3 SteeringWorld::nearest_image(std::size_t i, const Body& body) const {
    Vec3 x{particles_.x[i], particles_.y[i], particles_.z[i]};
    for (std::size_t k = 0; k < 3; ++k) {
        if (period_[k] == 0) continue;
        x[k] -= period_[k] * std::round((x[k] - static_cast<float>(body.vehicle.position[k])) / period_[k]);
    }
    return x;
}

void SteeringWorld::push_by_bodies(float dt) {
    if (bodies_.empty()) return;
    Particles& p = particles_;
    for (Body& body : bodies_) body.present = time_ + static_cast<double>(dt) > body.time;
    reactions_.begin(p.count);
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        reactions_[b].resize(bodies_.size());
        for (std::size_t k = 0; k < bodies_.size(); ++k) {
            for (std::size_t i = begin; i < end && bodies_[k].present; ++i) {
                if (p.kind[i] != Kind::fluid) continue;
                Vec3 v{p.vx[i], p.vy[i], p.vz[i]};
                push_away(bodies_[k], settings_, nearest_image(i, bodies_[k]), dt, mass(i), mass_factors(p)[i], v,
                          reactions_[b][k]);
                p.vx[i] = v[0], p.vy[i] = v[1], p.vz[i] = v[2];
            }
        }
    });
    reaction_.assign(bodies_.size(), {});
    for (std::size_t b = 0; b < block_count(p.count); ++b) {
        for (std::size_t k = 0; k < bodies_.size(); ++k) {
            reaction_[k] = behaviours::plus(reaction_[k], reactions_[b][k]);
        }
    }
}

void SteeringWorld::move_bodies(double dt) {
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
        Body& body = bodies_[k];
        if (!body.present) continue;
        behaviours::Vehicle& vehicle = body.vehicle;
        // Walls restrict the velocity that water and gravity give it.
        behaviours::Vector v = behaviours::plus(vehicle.velocity, behaviours::times(1 / vehicle.mass, reaction_[k]));
        v = behaviours::plus(v, {dt * gravity_x_, dt * gravity_y_, 0});
        keep_sphere_out(solids_, bed_, vehicle.position, body.radius, dt, v);
        behaviours::steer(vehicle, behaviours::times(vehicle.mass / dt, behaviours::minus(v, vehicle.velocity)), dt);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            vehicle.position[axis] = static_cast<double>(grid_.wrap(axis, static_cast<float>(vehicle.position[axis])));
        }
    }
}

void SteeringWorld::advance(float dt, SteeringStep& report) {
    Particles& p = particles_;
    const float opening = ends_->opening_x();
    moves_.begin(p.count);
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        BlockVelocities v;
        for (std::size_t i = begin; i < end; ++i) {
            const float v2 = p.vx[i] * p.vx[i] + p.vy[i] * p.vy[i] + p.vz[i] * p.vz[i];
            const float most = settings_.max_speed;
            const float share = p.kind[i] == Kind::fluid && v2 > most * most ? most / std::sqrt(v2) : 1.0F;
            v.x[i - begin] = share * p.vx[i], v.y[i - begin] = share * p.vy[i], v.z[i - begin] = share * p.vz[i];
        }
        if (settings_.wall_constraint) {
            solids_.apply_contact({p.x.data() + begin, p.y.data() + begin, p.z.data() + begin}, end - begin, dt, v,
                                  [](std::size_t, std::size_t, const Vec3&) {});
        }
        Moves moves;
        for (std::size_t i = begin; i < end; ++i) {
            if (p.kind[i] == Kind::fluid) {
                p.vx[i] = held_by_opening(opening, p.x[i], v.x[i - begin], dt);
                p.vy[i] = v.y[i - begin], p.vz[i] = v.z[i - begin];
            }
            const Vec3 u{p.vx[i], p.vy[i], p.vz[i]};
            Vec3 x{p.x[i] + dt * u[0], p.y[i] + dt * u[1], p.z[i] + dt * u[2]};
            moves.longest_squared =
                std::max(moves.longest_squared, dt * dt * (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]));
            moves.not_finite += std::isfinite(x[0] + x[1] + x[2]) ? 0U : 1U;
            moves.clamps += solids_.clamp(x) ? 1U : 0U;
            p.x[i] = x[0], p.y[i] = x[1], p.z[i] = x[2];
            const Vec3 moved{x[0] - lists_.x[i], x[1] - lists_.y[i], x[2] - lists_.z[i]};
            for (std::size_t k = 0; k < 3; ++k) {
                moves.least[k] = std::min(moves.least[k], moved[k]);
                moves.most[k] = std::max(moves.most[k], moved[k]);
            }
        }
        moves_[b] = moves;
    });
    const Moves all = moves_.total([](Moves& total, const Moves& block) {
        for (std::size_t k = 0; k < 3; ++k) {
            total.least[k] = std::min(total.least[k], block.least[k]);
            total.most[k] = std::max(total.most[k], block.most[k]);
        }
        total.clamps += block.clamps;
        total.not_finite += block.not_finite;
        total.longest_squared = std::max(total.longest_squared, block.longest_squared);
    });
    position_clamps_ += all.clamps;
    if (all.not_finite > 0) {
        throw RunError(
            ExitCode::numerical_failure,
            std::to_string(all.not_finite) +
                " fluid particles have a velocity or position that is not finite; lower /fluid/cfl, which is " +
                short_number(scene_.fluid->cfl));
    }
    report.max_displacement = std::sqrt(static_cast<double>(all.longest_squared));
    // No pair has moved against one another by more than the diagonal of the box of all moves.
    double squares = 0;
    for (std::size_t k = 0; k < 3; ++k) squares += std::pow(static_cast<double>(all.most[k] - all.least[k]), 2);
    lists_serve_ = p.count > 0 && squares < margin_ * margin_;
}

Vec3 SteeringWorld::place(std::size_t i) const {
    return {grid_.wrap(0, particles_.x[i]), grid_.wrap(1, particles_.y[i]), grid_.wrap(2, particles_.z[i])};
}

}  // namespace wade::fluid::steering
