#include "fluid_server/dfsph/fluid_world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/particle_volume.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "configs/scene/world.hpp"
#include "fluid_server/dfsph/step_measures.hpp"
#include "fluid_server/dfsph/time_step.hpp"
#include "fluid_server/dfsph/viscosity.hpp"
#include "fluid_server/neighbours/gradient_correction.hpp"
#include "fluid_server/particles/body_force.hpp"
#include "fluid_server/particles/filling.hpp"
#include "fluid_server/particles/inflow.hpp"
#include "fluid_server/particles/make_channel_ends.hpp"
#include "fluid_server/particles/site/site_filling.hpp"

namespace wade::fluid {

namespace {

double length(const std::array<double, 3>& v) {
    return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

// Largest speed of the particles, m/s.
double fastest_particle(const Particles& p) {
    double fastest = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        fastest = std::max(fastest, length({static_cast<double>(p.vx[i]), static_cast<double>(p.vy[i]),
                                            static_cast<double>(p.vz[i])}));
    }
    return fastest;
}

}  // namespace

FluidWorld::FluidWorld(const Scene& scene, ChannelEnds* ends)
    : scene_(scene),
      support_radius_(static_cast<float>(support_radius_of(scene.fluid))),
      volume_(static_cast<float>(particle_volume(scene.fluid))),
      particle_mass_(static_cast<float>(wade::particle_mass(scene.fluid))),
      kernel_(make_kernel(scene.fluid)),
      viscosity_(
          scene.fluid->kinematic_viscosity /
          std::visit([&](const auto& kernel) { return lattice_second_moment(kernel, scene.fluid->particle_spacing); },
                     kernel_)),
      confined_(false),
      particles_(static_cast<std::size_t>(scene.fluid->max_particles)),
      grid_(scene, support_radius_),
      lists_(particles_.capacity()),
      fields_(particles_.capacity()),
      solids_(scene),
      ends_(ends),
      gravity_x_(-scene.world->gravity * std::sin(std::atan(scene.channel->slope))),
      gravity_y_(-scene.world->gravity * std::cos(std::atan(scene.channel->slope))),
      depth_(scene),
      lowest_ground_(scene.site ? heights_of_ground(scene).lo : 0) {
    if (scene.site) {
        site_.emplace(site_shape(scene), support_radius_, static_cast<float>(scene.fluid->particle_spacing));
        fill_site(particles_, scene, *site_);
    } else if (ends_ == nullptr) {
        fill_scene(particles_, scene);
    }
    confined_ = fills_channel(scene, static_cast<double>(particles_.count) * particle_volume(scene.fluid));
    initial_speed_ = fastest_particle(particles_);
    if (ends_ == nullptr) {
        own_ends_ = make_channel_ends(scene, particles_);
        ends_ = own_ends_.get();
    }
    std::visit(
        [&](const auto& kernel) {
            solver_.emplace(scene, kernel.open_surface_density, kernel.relaxation, confined_, ends_->carry_inflow());
        },
        kernel_);
    if (is_rough(scene)) {
        friction_.emplace(scene, ends_->carry_inflow());
    }
    relaxes_ = site_.has_value();
}

// Lets particles that walls and slopes put too near to one another, or to their own images, go apart: density solves without
// weight. At the first step, so that a crowd meets a server of much water before.
void FluidWorld::relax() {
    constexpr int solves = 40;
    const auto d = static_cast<float>(scene_.fluid->particle_spacing);
    const float farthest = 0.1F * d, from_solids = 0.45F * d;
    const auto dt = static_cast<float>(0.3 * scene_.fluid->particle_spacing /
                                       std::sqrt(scene_.world->gravity * deepest_water(scene_)));
    Particles& p = particles_;
    const auto put = [&](std::size_t i, Vec3 x) {
        site_->clamp(x);
        site_->keep_away(x, from_solids);
        p.x[i] = x[0], p.y[i] = x[1], p.z[i] = x[2];
    };
    for_each_particle(p.count, [&](std::size_t i) { put(i, {p.x[i], p.y[i], p.z[i]}); });
    for (int n = 0; n < solves && p.count > 0; ++n) {
        grid_.sort(p, -std::numeric_limits<float>::infinity());
        find_neighbours();
        compute_density_and_diagonal(p, kernel_, volume_, false, lists_, fields_);
        solver_->solve_density(system(), DensitySolve::positions, dt, scene_.fluid->density_solve);
        for_each_particle(p.count, [&](std::size_t i) {
            const Vec3 way{dt * dt * fields_.ax[i], dt * dt * fields_.ay[i], dt * dt * fields_.az[i]};
            const float length = std::sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
            const float share = length > farthest ? farthest / length : 1;
            put(i, {p.x[i] + share * way[0], p.y[i] + share * way[1], p.z[i] + share * way[2]});
        });
    }
    std::fill(p.shift_pressure.begin(), p.shift_pressure.end(), 0.0F);
    relaxes_ = false;
}

void FluidWorld::find_neighbours() {
    if (site_) {
        fluid::find_neighbours(grid_, *site_, particles_, support_radius_, lists_);
    } else {
        fluid::find_neighbours(grid_, solids_, particles_, support_radius_, lists_);
    }
}

void FluidWorld::set_velocity(const std::function<std::array<double, 3>(const std::array<double, 3>& place)>& field) {
    Particles& p = particles_;
    for (std::size_t i = 0; i < p.count; ++i) {
        const std::array<double, 3> v =
            field({static_cast<double>(p.x[i]), static_cast<double>(p.y[i]), static_cast<double>(p.z[i])});
        p.vx[i] = static_cast<float>(v[0]), p.vy[i] = static_cast<float>(v[1]), p.vz[i] = static_cast<float>(v[2]);
    }
    initial_speed_ = fastest_particle(p);
}

void FluidWorld::capture(FluidState& state) const {
    if (state.particles.capacity() != particles_.capacity() || particles_.capacity() == 0) {
        state.scene = scene_;
        state.particles = Particles(particles_.capacity());
    }
    copy_particles(particles_, state.particles);
    state.time = time_;
    state.position_clamps = position_clamps_;
    state.emitter = ends_->state();
}

void FluidWorld::restore(const FluidState& state, const std::string& source) {
    check_state_fits(state, scene_, source);
    copy_particles(state.particles, particles_);
    time_ = state.time;
    relaxes_ = site_ && time_ == 0;
    position_clamps_ = state.position_clamps;
    if (state.emitter) {
        EmitterState emitter = *state.emitter;
        // The stock takes up a change of max_particles.
        emitter.stock += static_cast<std::uint64_t>(scene_.fluid->max_particles);
        emitter.stock -= static_cast<std::uint64_t>(state.scene.fluid->max_particles);
        ends_->restore(emitter, particles_, time_);
    }
}

StepReport FluidWorld::step(double remaining) {
    if (relaxes_) relax();
    StepReport report;
    const Plan plan = plan_step(remaining, report);
    StepStages stage(report.stages);
    // Places are those of the begin of the step until the last stage, and so are lists, densities and gradients.
    stage(Stage::sort, [&] { sort(report.dt); });
    if (pushers_) stage(Stage::people, [&] { push(plan); });
    stage(Stage::neighbours, [&] { find_neighbours(); });
    stage(Stage::density, [&] { find_densities(report); });
    stage(Stage::forces, [&] { apply_forces(plan, report); });
    if (plan.split) stage(Stage::divergence_solve, [&] { solve_divergence(plan, report); });
    if (plan.contact_comes_first()) stage(Stage::contact, [&] { apply_contact(plan, report); });
    stage(Stage::density_solve, [&] { solve_density(plan, report); });
    if (!plan.contact_comes_first()) stage(Stage::contact, [&] { apply_contact(plan, report); });
    stage(Stage::advance, [&] { advance(plan, report); });
    return report;
}

FluidWorld::Plan FluidWorld::plan_step(double remaining, StepReport& report) {
    const Motion now = measures_.motion(particles_);
    const double inflow = scene_.channel->velocity_history.empty()
                              ? 0
                              : largest_velocity(scene_.channel, time_, time_ + remaining);  // within the step
    const double v = std::max({now.fastest, fastest_plane(scene_.channel), inflow});
    const double depth = depth_.now(particles_, now.highest - lowest_ground_);
    solver_->set_layers(depth / scene_.fluid->particle_spacing);
    const double wave = std::sqrt(scene_.world->gravity * deepest_water(scene_));
    check_speed(particles_, v,
                std::max({wave, largest_velocity(scene_.channel), fastest_plane(scene_.channel), initial_speed_}),
                scene_.fluid);
    const WaterSpeeds speeds{v, wave, std::sqrt(scene_.world->gravity * depth), depth / scene_.fluid->particle_spacing};
    const TimeStep step = longest_step(scene_.fluid, speeds, remaining);
    report.dt = step.dt;
    Plan plan{static_cast<float>(step.dt), step.share, scene_.fluid->divergence_solve.max_iterations > 0};
    if (confined_ && plan.split) plan.theta = midpoint_theta(plan.share);
    return plan;
}

void FluidWorld::sort(double dt) {
    if (site_) site_->open_gates(time_);
    ends_->begin_step(particles_, time_, dt);
    ends_->take_out(grid_.sort(particles_, ends_->outflow_x()));
}

void FluidWorld::find_densities(StepReport& report) {
    compute_density_and_diagonal(particles_, kernel_, volume_, viscosity_ > 0, lists_, fields_);
    if (confined_) {
        correct_gradients(particles_, lists_, correction_, fields_);
    }
    const DensityError error = measures_.density_error(fields_.density, particles_.count);
    report.mean_density_error = error.mean;
    report.max_density_error = error.max;
    check_compression(error.mean, scene_.fluid);
}

void FluidWorld::push(const Plan& plan) {
    if (plan.theta > 0) {
        start_.keep(particles_);
    }
    pushers_(grid_, particles_, static_cast<double>(plan.to_midpoint()), static_cast<double>(1 + plan.theta));
}

void FluidWorld::apply_forces(const Plan& plan, StepReport& report) {
    if (plan.theta > 0 && !pushers_) {
        start_.keep(particles_);
    }
    const float duration = plan.to_midpoint();
    if (viscosity_ > 0) {
        apply_viscosity(particles_, fields_, static_cast<float>(viscosity_), duration);
    }
    const std::optional<double> driving = ends_->driving_acceleration(particles_, time_ + report.dt, report.dt);
    const double before = driving ? mean_velocity(particles_) : 0;
    apply_body_force(particles_, static_cast<float>(gravity_x_ - driving.value_or(0)), static_cast<float>(gravity_y_),
                     duration);
    // What the water really got: all velocities are near v_F, so that the same small change is rounded alike in all of them.
    if (driving) {
        report.driving_acceleration = gravity_x_ - (mean_velocity(particles_) - before) / static_cast<double>(duration);
    }
    if (friction_) {
        friction_->apply(particles_, duration);
    }
}

void FluidWorld::solve_divergence(const Plan& plan, StepReport& report) {
    report.divergence = solver_->solve_divergence(system(), plan.to_midpoint(), plan.share / (1 + plan.theta),
                                                  scene_.fluid->divergence_solve);
}

void FluidWorld::solve_density(const Plan& plan, StepReport& report) {
    const DensitySolve what = plan.split ? DensitySolve::positions : DensitySolve::velocities;
    report.density = solver_->solve_density(system(), what, plan.dt, scene_.fluid->density_solve);
    if (!plan.split) {
        apply_acceleration(particles_, fields_, plan.dt);
    }
    report.sweeps = 1 + report.divergence.sweeps + report.density.sweeps;
}

void FluidWorld::apply_contact(const Plan& plan, StepReport& report) {
    if (plan.theta > 0) {  // only now: how densities change in a step is what the velocities in its middle say
        go_on_from_midpoint(particles_, start_, plan.theta);
    }
    touch_solids(plan.dt, report);
}

void FluidWorld::advance(const Plan& plan, StepReport& report) {
    move(plan.dt, plan.split ? plan.dt : 0, report);
    ends_->end_step(particles_, {lists_.x.data(), particles_.count}, report.dt);
    time_ += report.dt;
}

PressureSystem FluidWorld::system() {
    return {particles_, lists_, confined_ ? &correction_ : nullptr, fields_};
}

}  // namespace wade::fluid
