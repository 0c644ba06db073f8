#include "fluid_server/mixed/model.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "configs/checks/scene_checks.hpp"
#include "configs/errors/exit_code.hpp"
#include "configs/scene/fluid.hpp"
#include "fluid_server/dfsph/dfsph_model.hpp"
#include "fluid_server/shallow_water/model.hpp"

namespace wade::fluid::mixed {

namespace {

std::string digits(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return text;
}

}  // namespace

Closure closure_of(const MixedWorld& world) {
    Closure closure;
    double owed = 0, momentum = 0, carried = 0;
    for (const EndAccount& account : world.accounts()) {
        owed += std::abs(account.owed);
        closure.most = std::max(closure.most, account.most_owed);
        closure.passed += account.passed;
        momentum += std::abs(account.grid_momentum - account.particle_momentum);
        carried += account.passed_momentum;
    }
    closure.volume = closure.passed > 0 ? owed / closure.passed : 0;
    closure.momentum = carried > 0 ? momentum / carried : 0;
    return closure;
}

// Particles wherever they may be, and cells everywhere; the guards come on top of both.
Estimate MixedModel::estimate(const Scene& scene) {
    const Estimate particles = DfsphModel::estimate(scene);
    const Estimate cells = shallow_water::ShallowWaterModel::estimate(scene);
    return {particles.particles + cells.particles, particles.memory + cells.memory - empty_server,
            particles.cpu_time + cells.cpu_time};
}

std::uint32_t MixedModel::capacity() const {
    const int particles = world_.particle_water().scene().fluid->max_particles;
    return static_cast<std::uint32_t>(std::max(particles, 0)) + world_.columns().capacity();
}

void MixedModel::add(const MixedStep& step, shm::Diagnostics& d) {
    ++d.sub_steps;
    d.last_dt_s = step.dt;
    time_ += step.dt;
    const Window& window = world_.window();
    awake_ += step.dt * static_cast<double>(window.end - window.begin) * world_.grid_water().grid.dx;
    if (!step.particles) return;
    most_particles_ = std::max<std::uint64_t>(most_particles_, world_.particle_water().particles().count);
    d.density_iterations += static_cast<std::uint32_t>(step.particles->density.iterations);
    d.divergence_iterations += static_cast<std::uint32_t>(step.particles->divergence.iterations);
    d.mean_density_error = std::fmax(d.mean_density_error, step.particles->mean_density_error);
    d.max_density_error = std::fmax(d.max_density_error, step.particles->max_density_error);
}

shm::Diagnostics MixedModel::advance_frame(const FrameInterval& interval) {
    const auto start = std::chrono::steady_clock::now();
    const double frame_time = interval.duration();
    shm::Diagnostics d;
    double driving = 0, remaining = frame_time;
    world_.people().frame_time = frame_time;
    try {
        world_.need(needed_);
        // What is left after the last sub-step is rounding.
        while (remaining > 1e-9 * frame_time) {
            const MixedStep step = world_.step(remaining);
            remaining -= step.dt;
            driving += step.driving_acceleration * step.dt;
            add(step, d);
        }
    } catch (const RunError& error) {
        throw RunError(error.code(), "the water failed at t = " + short_number(time_) + " s: " + error.what());
    }
    const auto elapsed = std::chrono::steady_clock::now() - start;
    world_.columns().count(world_.grid_water());
    d.solver_ns = static_cast<std::uint64_t>(std::chrono::nanoseconds(elapsed).count());
    // In the window the cells follow the particles.
    shallow_water::note_water(world_.grid_water(), driving / frame_time, world_.outflow(), d);
    world_.people().pushes.clear();
    note_people(world_.people(), d);
    d.position_clamps = world_.particle_water().position_clamps();
    return d;
}

std::uint32_t MixedModel::write_frame(const shm::FrameFields& slot) const {
    std::uint32_t to = world_.columns().write(world_.grid_water(), slot);
    if (world_.window().empty()) return to;
    const Particles& p = world_.particle_water().particles();
    const double spacing = world_.grid_water().scene.fluid->particle_spacing;
    const auto mass = static_cast<double>(world_.particle_water().particle_mass());
    for (std::size_t i = 0; i < p.count; ++i) {
        const double share = share_in_window(static_cast<double>(p.x[i]), world_.ends(), spacing);
        if (share <= 0) continue;
        slot.mass[to] = static_cast<float>(share * mass);
        slot.vx[to] = p.vx[i], slot.vy[to] = p.vy[i], slot.vz[to] = p.vz[i];
        slot.px[to] = p.x[i], slot.py[to] = p.y[i], slot.pz[to] = p.z[i];
        ++to;
    }
    return to;
}

std::string MixedModel::remarks() const {
    const shallow_water::Grid& grid = world_.grid_water().grid;
    const Closure closure = closure_of(world_);
    char text[400];
    std::snprintf(
        text, sizeof text,
        "grid of %zu x %zu cells; particles in %.1f %% of the channel on average, at most %llu; "
        "through the ends of the window passed %.5g m3, closure error %.2g %% of it, at most %.2g m3 were owed; "
        "momentum carried differs by %.2g %%",
        grid.nx, grid.nz, time_ > 0 ? 100 * awake_ / (time_ * grid.x.length()) : 0.0,
        static_cast<unsigned long long>(most_particles_), closure.passed, 100 * closure.volume, closure.most,
        100 * closure.momentum);
    if (!world_.momentum().kept) return text;
    const double owed = world_.momentum().most_owed * world_.grid_water().scene.fluid->rest_density;
    return text + std::string("; of all momentum at most ") + digits(owed) + " N s were owed";
}

}  // namespace wade::fluid::mixed
