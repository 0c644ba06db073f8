#include "crowd_client/session/progress.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "configs/scene/scene_frames.hpp"

namespace wade::crowd {
namespace {

[[gnu::format(printf, 1, 2)]] std::string print(const char* format, ...) {
    char buffer[256];
    std::va_list values;
    va_start(values, format);
    const int length = std::vsnprintf(buffer, sizeof buffer, format, values);
    va_end(values);
    return {buffer, static_cast<std::size_t>(std::min(std::max(length, 0), static_cast<int>(sizeof buffer) - 1))};
}

std::string water_text(const shm::Frame& frame) {
    const shm::Diagnostics& d = frame.diagnostics;
    std::string text = print("water %u particles", frame.count);
    if (!std::isnan(d.mean_density_error)) {
        text += print(", density error %.3f %% (max %.2f %%)", 100 * d.mean_density_error, 100 * d.max_density_error);
    }
    if (d.sub_steps > 0) {
        text += print(", %u+%u iterations in %u sub-steps", d.divergence_iterations, d.density_iterations, d.sub_steps);
    }
    if (!std::isnan(d.mean_depth_m)) text += print(", depth %.2f m", d.mean_depth_m);
    if (!std::isnan(d.mean_speed_m_s)) text += print(", %.2f m/s", d.mean_speed_m_s);
    return text;
}

std::string duration_text(double seconds) {
    const auto whole = static_cast<long>(std::ceil(seconds));
    if (whole < 60) return print("%ld s", whole);
    return print("%ld min %02ld s", whole / 60, whole % 60);
}

}  // namespace

std::string progress_line(const CrowdWorld& crowd, const shm::Frame& frame, double wall_time) {
    const std::uint64_t last = steps_of(crowd.scene);
    const double time = static_cast<double>(crowd.steps) * crowd.dt;
    std::string line = print("t %.1f s  step %llu/%llu  active %zu arrived %zu dead %zu  ", time,
                             static_cast<unsigned long long>(crowd.steps), static_cast<unsigned long long>(last),
                             crowd.active.size(), crowd.arrived, crowd.dead);
    line += water_text(frame);
    if (wall_time > 0 && time > 0) {
        const double factor = time / wall_time;
        const double left = static_cast<double>(last - std::min(last, crowd.steps)) * crowd.dt / factor;
        line += print("  %.2f x real time, at most ", factor) + duration_text(left) + " to go";
    }
    return line;
}

std::string progress_line(const CrowdsProgress& crowds, const shm::Frame& frame, double wall_time) {
    std::string line = print("t %.1f s  %zu of %zu crowds walk, %zu agents  ", crowds.time, crowds.walking,
                             crowds.crowds, crowds.active);
    line += water_text(frame);
    if (wall_time > 0) line += print("  %.2f x real time", crowds.time / wall_time);
    return line;
}

std::string summary_text(const CrowdWorld& crowd, const RunSummary& summary, double wall_time) {
    const double time = static_cast<double>(crowd.steps) * crowd.dt;
    std::string text = print("%s: %zu of %zu arrived", summary.status.c_str(), crowd.arrived, crowd.agents.size());
    if (crowd.arrived > 0)
        text += print(", the last after %.1f s", static_cast<double>(crowd.last_arrival_step) * crowd.dt);
    text += print("; %zu dead, %zu active\n", crowd.dead, crowd.active.size());
    text += print("%.1f s simulated in %.1f s of wall time", time, wall_time);
    if (wall_time > 0) text += print(" (%.2f s a second)", time / wall_time);
    if (summary.dropped_frames > 0) {
        text += print("; %llu frames taken, %llu dropped", static_cast<unsigned long long>(summary.frames),
                      static_cast<unsigned long long>(summary.dropped_frames));
    }
    const FluidSummary& fluid = summary.fluid;
    text += print("; water: up to %u particles", fluid.particles_max);
    if (const auto error = fluid.density_error.value()) text += print(", mean density error %.3f %%", 100 * *error);
    if (fluid.steps > 0)
        text += print(", %llu position clamps", static_cast<unsigned long long>(fluid.position_clamps));
    if (fluid.resident_bytes > 0)
        text += print(", server memory %.0f MB", static_cast<double>(fluid.resident_bytes) * 1e-6);
    return text;
}

}  // namespace wade::crowd
