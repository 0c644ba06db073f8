#include "fluid_server/steering/steering_model.hpp"

#include <algorithm>
#include <chrono>

#include "configs/checks/scene_checks.hpp"
#include "configs/errors/exit_code.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "configs/scene/world.hpp"
#include "fluid_server/particles/inflow.hpp"

namespace wade::fluid {

// Bytes a particle that there is room for and a pair of the lists, and seconds of CPU time a particle and step: measured.
Estimate SteeringModel::estimate(const Scene& scene) {
    constexpr double bytes_of_room = 90, bytes_of_pair = 5, step_cost = 1e-7;
    const steering::Settings settings = steering::make_settings(scene);
    const double room = std::max(scene.fluid->max_particles, 1);
    Estimate estimate;
    estimate.particles = particles_expected(scene);
    const auto n = static_cast<double>(estimate.particles);
    estimate.memory = empty_server + bytes_of_room * room +
                      bytes_of_pair * neighbours_within(settings.reach, scene.fluid) * n +
                      memory_of_cells(scene, static_cast<float>(settings.reach), n) +
                      memory_of_frames(scene, static_cast<std::uint64_t>(room));
    const double speed = largest_velocity(scene.channel) + settings.wave_speed;
    const double rate = speed / (scene.fluid->cfl * scene.fluid->particle_spacing);  // steps a second
    estimate.cpu_time = scene.duration * std::max(rate, scene.frame_rate) * n * step_cost;
    return estimate;
}

std::uint32_t SteeringModel::capacity() const {
    return static_cast<std::uint32_t>(std::max(world_.scene().fluid->max_particles, 1));
}

shm::Diagnostics SteeringModel::advance_frame(const FrameInterval& interval) {
    const auto start = std::chrono::steady_clock::now();
    const double frame_time = interval.duration();
    shm::Diagnostics d;
    double driving = 0;
    double remaining = frame_time;
    ++frame_;
    // What is left after the last sub-step is rounding.
    while (remaining > 1e-9 * frame_time) {
        try {
            const steering::SteeringStep step = world_.step(remaining);
            remaining -= step.dt;
            ++d.sub_steps;
            d.last_dt_s = step.dt;
            driving += step.driving_acceleration * step.dt;
        } catch (const RunError& error) {
            throw RunError(error.code(), "the water failed in frame " + std::to_string(frame_) +
                                             ", at t = " + short_number(world_.time()) + " s: " + error.what());
        }
    }
    const auto elapsed = std::chrono::steady_clock::now() - start;
    d.solver_ns = static_cast<std::uint64_t>(std::chrono::nanoseconds(elapsed).count());
    measure(d);
    if (world_.scene().channel->flow == Flow::recirculating) d.driving_acceleration_m_s2 = driving / frame_time;
    d.position_clamps = world_.position_clamps();
    d.recycled_particles = world_.emitter().recycled;
    return d;
}

void SteeringModel::measure(shm::Diagnostics& d) const {
    const Particles& p = world_.particles();
    double n = 0, mass = 0, height = 0, above_bed = 0, speed = 0, squares = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        if (p.kind[i] != Kind::fluid || world_.has_left(i)) continue;
        const double m = world_.mass(i);
        const auto x = static_cast<double>(p.vx[i]), y = static_cast<double>(p.vy[i]), z = static_cast<double>(p.vz[i]);
        const auto at = static_cast<double>(p.y[i]);
        n += 1;
        mass += m;
        height += m * at;
        above_bed += at - (bed_.empty() ? 0 : static_cast<double>(bed_height(bed_, p.x[i])));
        speed -= x;
        squares += m * (x * x + y * y + z * z);
    }
    d.kinetic_energy_j = 0.5 * squares;
    d.potential_energy_j = world_.scene().world->gravity * height;
    if (n > 0) {
        d.mean_depth_m = 2 * above_bed / n;
        d.mean_speed_m_s = speed / n;
    }
}

std::uint32_t SteeringModel::write_frame(const shm::FrameFields& slot) const {
    const Particles& p = world_.particles();
    std::uint32_t n = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        if (world_.has_left(i)) continue;
        const Vec3 x = world_.place(i);
        slot.mass[n] = static_cast<float>(world_.mass(i));
        slot.vx[n] = p.vx[i], slot.vy[n] = p.vy[i], slot.vz[n] = p.vz[i];
        slot.px[n] = x[0], slot.py[n] = x[1], slot.pz[n] = x[2];
        ++n;
    }
    return n;
}

std::string SteeringModel::remarks() const {
    std::vector<std::string> lines;
    for (std::size_t k = 0; k < world_.bodies().size(); ++k) {
        const steering::Body& body = world_.bodies()[k];
        const auto& x = body.vehicle.position;
        const std::string where =
            "is at (" + short_number(x[0]) + ", " + short_number(x[1]) + ", " + short_number(x[2]) + ") m at the end";
        lines.push_back("body " + std::to_string(k) + " of /fluid/steering/bodies " +
                        (body.present ? where : "has not appeared"));
    }
    if (world_.emitter().layers_missed > 0) {
        lines.push_back("warning: the stock was empty for " + std::to_string(world_.emitter().layers_missed) +
                        " layers of the emitter, raise fluid.max_particles");
    }
    std::string text;
    for (const std::string& line : lines) {
        if (!text.empty()) text += '\n';
        text += line;
    }
    return text;
}

}  // namespace wade::fluid
