#include "crowd_client/results/run_summary.hpp"

#include <algorithm>
#include <cmath>

#include "configs/errors/exit_code.hpp"
#include "configs/program/peer_support.hpp"
#include "configs/scene/scene_frames.hpp"
#include "crowd_client/crowd_motion.hpp"
#include "crowd_client/results/output_file.hpp"

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

std::optional<MomentumBalance> momentum_balance(const shm::Diagnostics& d, const Vector2d& got) {
    MomentumBalance balance{got,
                            {d.taken_by_people_x_n_s, d.taken_by_people_z_n_s},
                            {d.missing_for_people_x_n_s, d.missing_for_people_z_n_s}};
    const bool says = balance.lost.allFinite() && balance.missing.allFinite();
    const bool before_1_3 = says && balance.lost.isZero(0) && balance.missing.isZero(0) && !got.isZero(0);
    return says && !before_1_3 ? std::optional(balance) : std::nullopt;
}

bool run_is_over(const CrowdWorld& crowd) {
    const bool nobody_left = crowd.agents.size() > 0 && crowd.active.empty() && !may_come_out(crowd);
    return crowd.steps >= steps_of(crowd.scene) || (nobody_left && crowd.scene.stop_when_no_agent_is_active);
}

void end_summary(RunSummary& summary, const CrowdWorld& crowd) {
    // With rates that do not fit the duration, the last step may be due after the last frame.
    const bool duration_is_over = summary.time >= crowd.scene.duration - 0.5 / crowd.scene.frame_rate;
    const bool completed = run_is_over(crowd) || duration_is_over;
    summary.status = completed ? "completed" : "stream_ended";
    if (completed) return;
    summary.message = "the stream of water ended after frame " + std::to_string(summary.last_frame) +
                      ", before the scene's duration was over";
}

void fail_summary(RunSummary& summary, const std::exception& error) {
    const bool was_well =
        summary.status == "running" || summary.status == "completed" || summary.status == "stream_ended";
    if (!was_well) return;
    summary.status = status_of(error);
    summary.message = error.what();
}

std::string status_of(const std::exception& error) {
    const auto* output = dynamic_cast<const OutputError*>(&error);
    return output != nullptr && output->disk_full() ? "disk_full" : status_of(exit_code_of<shm::Error>(error));
}

std::string status_of(int exit_code) {
    switch (static_cast<ExitCode>(exit_code)) {
        case ExitCode::ok:
            return "completed";
        case ExitCode::bad_configuration:
            return "bad_configuration";
        case ExitCode::attach_timeout:
            return "attach_timeout";
        case ExitCode::peer_dead:
            return "peer_dead";
        case ExitCode::peer_aborted:
            return "peer_aborted";
        case ExitCode::protocol_violation:
            return "protocol_violation";
        case ExitCode::step_timeout:
            return "step_timeout";
        case ExitCode::name_in_use:
            return "name_in_use";
        case ExitCode::numerical_failure:
            return "numerical_failure";
        case ExitCode::interrupted:
        case ExitCode::terminated:
            return "interrupted";
        case ExitCode::unexpected:
            break;
    }
    return "failed";
}

}  // namespace wade::crowd
