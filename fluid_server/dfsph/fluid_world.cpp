#include "fluid_server/dfsph/fluid_world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <variant>

#include "configs/checks/scene_checks.hpp"
#include "configs/errors/exit_code.hpp"
#include "configs/scene/particle_volume.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "fluid_server/dfsph/forces.hpp"
#include "fluid_server/dfsph/stabler_settings.hpp"
#include "fluid_server/dfsph/time_step.hpp"
#include "fluid_server/neighbours/gradient_correction.hpp"
#include "fluid_server/particles/body_force.hpp"
#include "fluid_server/particles/filling.hpp"
#include "fluid_server/particles/inflow.hpp"

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

// A mean compression beyond this is no water any more.
constexpr double collapse = 0.1;

// `what` happened and what to change in the scene.
[[noreturn]] void fail(const std::string& what, const Fluid& fluid) {
    throw RunError(ExitCode::numerical_failure, what + "; " + advice(fluid));
}

// " at (x, y, z) m"
std::string place_of_fastest(const Particles& p) {
    const auto square = [&](std::size_t i) { return p.vx[i] * p.vx[i] + p.vy[i] * p.vy[i] + p.vz[i] * p.vz[i]; };
    std::size_t fastest = 0;
    for (std::size_t i = 1; i < p.count; ++i) fastest = square(i) > square(fastest) ? i : fastest;
    const auto text = [](float v) { return short_number(static_cast<double>(v)); };
    return " at (" + text(p.x[fastest]) + ", " + text(p.y[fastest]) + ", " + text(p.z[fastest]) + ") m";
}

}  // namespace

FluidWorld::FluidWorld(const Scene& scene, OpenEnds* ends)
    : scene_(scene),
      support_radius_(static_cast<float>(support_radius_of(scene.fluid))),
      volume_(static_cast<float>(particle_volume(scene.fluid))),
      particle_mass_(static_cast<float>(wade::particle_mass(scene.fluid))),
      kernel_(make_kernel(scene.fluid)),
      viscosity_(
          scene.fluid.kinematic_viscosity /
          std::visit([&](const auto& kernel) { return lattice_second_moment(kernel, scene.fluid.particle_spacing); },
                     kernel_)),
      confined_(false),
      particles_(static_cast<std::size_t>(scene.fluid.max_particles)),
      grid_(scene, support_radius_),
      lists_(particles_.capacity()),
      fields_(particles_.capacity()),
      solids_(scene),
      ends_(ends),
      gravity_x_(-scene.world.gravity * std::sin(std::atan(scene.channel.slope))),
      gravity_y_(-scene.world.gravity * std::cos(std::atan(scene.channel.slope))),
      depth_(scene),
      outflow_x_(ends == nullptr && scene.channel.flow == Flow::emitter ? static_cast<float>(scene.channel.x.lo)
                                                                        : -std::numeric_limits<float>::infinity()) {
    if (ends_ == nullptr) {
        fill_scene(particles_, scene);
    }
    confined_ = fills_channel(scene, static_cast<double>(particles_.count) * particle_volume(scene.fluid));
    std::visit([&](const auto& kernel) { solver_.emplace(kernel.open_surface_density, kernel.relaxation, confined_); },
               kernel_);
    if (ends_ != nullptr) {
        solver_->guide_inflow();
    }
    initial_speed_ = fastest_particle(particles_);
    if (scene.channel.manning_n > 0) {
        friction_.emplace(scene, ends_ != nullptr);
    }
    if (ends_ == nullptr && scene.channel.flow == Flow::emitter) {
        emitter_.emplace(scene, particles_.count);
        emitter_->emit(particles_, 0);
        solver_->accept_dense_inflow();
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
    state.emitter.reset();
    if (emitter_) state.emitter = emitter_->state();
}

void FluidWorld::restore(const FluidState& state, const std::string& source) {
    check_state_fits(state, scene_, source);
    copy_particles(state.particles, particles_);
    time_ = state.time;
    position_clamps_ = state.position_clamps;
    if (emitter_) {
        EmitterState emitter = *state.emitter;
        // The stock takes up a change of max_particles.
        emitter.stock += static_cast<std::uint64_t>(scene_.fluid.max_particles);
        emitter.stock -= static_cast<std::uint64_t>(state.scene.fluid.max_particles);
        emitter_->restore(emitter);
        emitter_->set_velocity(particles_, velocity_at(scene_.channel, time_));
    }
}

StepReport FluidWorld::step(double remaining) {
    StepReport report;
    report.dt = time_step(remaining);
    const auto dt = static_cast<float>(report.dt);
    const Fluid& fluid = scene_.fluid;

    StageClock clock(report.stages);
    if (ends_ != nullptr) {
        ends_->begin_step(particles_, report.dt);
    }
    const std::size_t left = grid_.sort(particles_, outflow_x_);
    if (emitter_) {
        emitter_->recycle(left);
        if (!scene_.channel.velocity_history.empty()) {
            emitter_->set_velocity(particles_, mean_velocity(scene_.channel, time_, time_ + report.dt));
        }
    }
    clock.finished(Stage::sort);
    find_neighbours(grid_, solids_, particles_, support_radius_, lists_);
    clock.finished(Stage::neighbours);
    compute_density_and_diagonal(particles_, kernel_, volume_, lists_, fields_);
    if (confined_) {
        correct_gradients(particles_, lists_, correction_, fields_);
    }
    const GradientCorrection* const correction = confined_ ? &correction_ : nullptr;
    measure_density_error(report);
    clock.finished(Stage::density);

    const bool split = fluid.divergence_solve.max_iterations > 0;
    const float theta = confined_ && split ? midpoint_theta(step_share_) : 0;
    if (theta > 0) {
        start_.keep(particles_);
    }
    apply_forces(dt / (1 + theta), dt, report);
    clock.finished(Stage::forces);
    const auto touch_solids = [&] {
        apply_contact(dt, report);
        clock.finished(Stage::contact);
    };
    if (split) {
        report.divergence = solver_->solve_divergence(particles_, lists_, correction, fields_, dt / (1 + theta),
                                                      step_share_ / (1 + theta), fluid.divergence_solve);
        clock.finished(Stage::divergence_solve);
        if (theta == 0) {
            touch_solids();
        }
        report.density = solver_->solve_density(particles_.shift_pressure, particles_, lists_, correction, fields_, dt,
                                                fluid.density_solve);
        clock.finished(Stage::density_solve);
        if (theta > 0) {  // only now: how densities change in a step is what the velocities in its middle say
            go_on_from_midpoint(particles_, start_, theta);
            touch_solids();
        }
        advance(dt, dt, report);
    } else {
        report.density = solver_->solve_density(particles_.pressure, particles_, lists_, correction, fields_, dt,
                                                fluid.density_solve);
        apply_acceleration(particles_, fields_, dt);
        clock.finished(Stage::density_solve);
        touch_solids();
        advance(dt, 0, report);
    }
    if (emitter_) {
        emitter_->emit(particles_, dt);
    }
    if (ends_ != nullptr) {
        ends_->end_step(particles_, {lists_.x.data(), particles_.count}, report.dt);
    }
    clock.finished(Stage::advance);
    time_ += report.dt;
    report.sweeps = 1 + (viscosity_ > 0 ? 1 : 0) + report.divergence.sweeps + report.density.sweeps;
    return report;
}

void FluidWorld::apply_forces(float duration, float dt, StepReport& report) {
    if (viscosity_ > 0) {
        apply_viscosity(particles_, lists_, fields_, static_cast<float>(viscosity_), duration);
    }
    if (scene_.channel.flow == Flow::recirculating) {
        report.driving_acceleration =
            -driving_acceleration(particles_, velocity_at(scene_.channel, time_ + report.dt), dt);
    }
    if (ends_ != nullptr) {
        report.driving_acceleration = -ends_->acceleration();
    }
    apply_body_force(particles_, static_cast<float>(gravity_x_ - report.driving_acceleration),
                     static_cast<float>(gravity_y_), duration);
    if (friction_) {
        friction_->apply(particles_, duration);
    }
}

double FluidWorld::time_step(double remaining) {
    extremes_.begin(particles_.count);
    for_each_block(particles_.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        float fastest = 0, highest = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const float v2 = particles_.vx[i] * particles_.vx[i] + particles_.vy[i] * particles_.vy[i] +
                             particles_.vz[i] * particles_.vz[i];
            fastest = std::max(fastest, v2);
            highest = std::max(highest, particles_.y[i]);
        }
        extremes_[b].max = static_cast<double>(fastest);
        extremes_[b].highest = static_cast<double>(highest);
    });
    const Extremes all = extremes_.total([](Extremes& total, const Extremes& block) {
        total.max = std::max(total.max, block.max);
        total.highest = std::max(total.highest, block.highest);
    });
    double v = std::max(std::sqrt(all.max), fastest_plane(scene_.channel));
    if (!scene_.channel.velocity_history.empty()) {
        v = std::max(v, largest_velocity(scene_.channel, time_, time_ + remaining));  // what comes in within the step
    }
    const double depth = depth_.now(particles_, all.highest);
    solver_->set_layers(depth / scene_.fluid.particle_spacing);
    const double wave = std::sqrt(scene_.world.gravity * deepest_water(scene_));
    const double expected =
        std::max({wave, largest_velocity(scene_.channel), fastest_plane(scene_.channel), initial_speed_});
    if (expected > 0 && v > runaway * expected) {
        fail("a fluid particle" + place_of_fastest(particles_) + " moves at " + short_number(v) + " m/s, more than " +
                 std::to_string(runaway) + " times the " + short_number(expected) +
                 " m/s of the scene's depth and velocity",
             scene_.fluid);
    }
    const TimeStep step = longest_step(scene_.fluid, {v, wave, std::sqrt(scene_.world.gravity * depth)}, remaining);
    step_share_ = step.share;
    return step.dt;
}

void FluidWorld::measure_density_error(StepReport& report) {
    const auto& density = fields_.density;
    extremes_.begin(particles_.count);
    for_each_block(particles_.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        Extremes& block = extremes_[b];
        for (std::size_t i = begin; i < end; ++i) {
            const double error = std::max(0.0, static_cast<double>(density[i]) - 1);
            block.sum += error;
            block.max = std::max(block.max, error);
        }
    });
    const Extremes all = extremes_.total([](Extremes& total, const Extremes& block) {
        total.sum += block.sum;
        total.max = std::max(total.max, block.max);
    });
    report.mean_density_error = particles_.count == 0 ? 0 : all.sum / static_cast<double>(particles_.count);
    report.max_density_error = all.max;
    if (report.mean_density_error > collapse) {
        fail("the fluid is compressed by " + short_number(100 * report.mean_density_error) +
                 " % on average, more than " + short_number(100 * collapse) + " %",
             scene_.fluid);
    }
}

Places FluidWorld::places(std::size_t begin) const {
    return {particles_.x.data() + begin, particles_.y.data() + begin, particles_.z.data() + begin};
}

void FluidWorld::apply_contact(float dt, StepReport& report) {
    Particles& p = particles_;
    sums_.begin(p.count);
    contact_sums_.begin(p.count);
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        contact_sums_[b].resize(scene_.obstacles.size());
        const auto on_obstacle = [&](std::size_t o, std::size_t i, const Vec3& removed) {
            for (std::size_t k = 0; k < 3 && p.kind[begin + i] == Kind::fluid; ++k) {
                contact_sums_[b][o][k] += static_cast<double>(removed[k] / dt);
            }
        };
        BlockVelocities v;
        for (std::size_t i = begin; i < end; ++i) {
            v.x[i - begin] = p.vx[i], v.y[i - begin] = p.vy[i], v.z[i - begin] = p.vz[i];
        }
        solids_.apply_contact(places(begin), end - begin, dt, v, on_obstacle);
        double lifted = 0;  // m/s
        for (std::size_t i = begin; i < end; ++i) {
            if (p.kind[i] == Kind::fluid) {
                lifted += static_cast<double>(v.y[i - begin] - p.vy[i]);
                p.vx[i] = emitter_ ? emitter_->limit(p.x[i], v.x[i - begin], dt) : v.x[i - begin];
                p.vy[i] = v.y[i - begin], p.vz[i] = v.z[i - begin];
            }
        }
        sums_[b] = lifted / static_cast<double>(dt);
    });
    const auto mass = static_cast<double>(particle_mass_);
    contact_forces_.assign(scene_.obstacles.size(), {});
    for (std::size_t b = 0; b < block_count(particles_.count); ++b) {
        for (std::size_t o = 0; o < contact_forces_.size(); ++o) {
            for (std::size_t k = 0; k < 3; ++k) {
                contact_forces_[o][k] += mass * contact_sums_[b][o][k];
            }
        }
    }
    report.contact_force = mass * sums_.total([](double& sum, double a) { sum += a; });
}

void FluidWorld::advance(float dt, float shift_time, StepReport& report) {
    Particles& p = particles_;
    const ParticleFields& f = fields_;
    guards_.begin(p.count);
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        BlockVelocities v;
        for (std::size_t i = begin; i < end; ++i) {
            v.x[i - begin] = p.vx[i] + shift_time * f.ax[i];
            v.y[i - begin] = p.vy[i] + shift_time * f.ay[i];
            v.z[i - begin] = p.vz[i] + shift_time * f.az[i];
        }
        if (shift_time > 0) {
            solids_.apply_contact(places(begin), end - begin, dt, v, [](std::size_t, std::size_t, const Vec3&) {});
        }
        Guards guards;
        for (std::size_t i = begin; i < end; ++i) {
            // The lattice of the emitter goes its way.
            Vec3 u{p.vx[i], p.vy[i], p.vz[i]};
            if (p.kind[i] == Kind::fluid || ends_ != nullptr) {
                u = {v.x[i - begin], v.y[i - begin], v.z[i - begin]};
                u[0] = emitter_ && shift_time > 0 ? emitter_->limit(p.x[i], u[0], dt) : u[0];
            }
            Vec3 x{grid_.wrap(0, p.x[i] + dt * u[0]), grid_.wrap(1, p.y[i] + dt * u[1]),
                   grid_.wrap(2, p.z[i] + dt * u[2])};
            const float v2 = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
            guards.longest_squared = std::max(guards.longest_squared, dt * dt * v2);
            guards.not_finite += std::isfinite(x[0] + x[1] + x[2]) ? 0U : 1U;
            guards.clamps += solids_.clamp(x) ? 1U : 0U;
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
    if (all.not_finite > 0) {
        fail(std::to_string(all.not_finite) + " fluid particles have a velocity or position that is not finite",
             scene_.fluid);
    }
    report.max_displacement = std::sqrt(static_cast<double>(all.longest_squared));
    if (report.max_displacement > static_cast<double>(support_radius_)) {
        fail("a fluid particle moves by " + short_number(report.max_displacement) +
                 " m in one step, further than the support radius of " +
                 short_number(static_cast<double>(support_radius_)) + " m",
             scene_.fluid);
    }
}

}  // namespace wade::fluid
