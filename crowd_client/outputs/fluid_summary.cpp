#include "crowd_client/outputs/fluid_summary.hpp"

#include <algorithm>
#include <cmath>

namespace wade::crowd {

void WeightedMean::add(double value, double its_weight) {
    if (std::isnan(value)) return;
    sum += its_weight * value;
    weight += its_weight;
}

std::optional<double> WeightedMean::value() const {
    if (!(weight > 0)) return std::nullopt;
    return sum / weight;
}

void add_frame(FluidSummary& summary, const shm::Frame& frame, double time, double dt) {
    const shm::Diagnostics& d = frame.diagnostics;
    summary.particles_max = std::max(summary.particles_max, frame.count);
    summary.steps += d.sub_steps;
    summary.particle_steps += static_cast<std::uint64_t>(frame.count) * d.sub_steps;
    summary.solver_ns += d.solver_ns;
    summary.position_clamps = std::max(summary.position_clamps, d.position_clamps);
    summary.recycled_particles = std::max(summary.recycled_particles, d.recycled_particles);
    summary.resident_bytes = std::max(summary.resident_bytes, d.resident_bytes);
    // Half a frame of slack against the rounding of time - dt.
    if (time - 0.5 * dt < FluidSummary::settling_time) return;
    summary.depth.add(d.mean_depth_m, 1);
    summary.speed.add(d.mean_speed_m_s, 1);
    summary.density_error.add(d.mean_density_error, std::max(1U, d.sub_steps));
    if (!std::isnan(d.max_density_error)) {
        summary.max_density_error = std::max(summary.max_density_error.value_or(0), d.max_density_error);
    }
}

}  // namespace wade::crowd
