#include "crowd_client/session/progress.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "configs/program/time_left.hpp"
#include "crowd_client/crowd_motion.hpp"
#include "crowd_client/standing.hpp"

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

constexpr std::size_t columns = 100;

// Words of a line in their order. A line that is too long loses `more`, then the health, then the water.
struct Words {
    std::string begin, water, health, more, pace;
    [[nodiscard]] std::string line() const {
        for (const std::string& middle : {water + health + more, water + health, water}) {
            const std::string all = begin + "  " + middle + pace;
            if (all.size() <= columns) return all;
        }
        return (begin + pace).substr(0, columns);
    }
};

Words words_of_water(const shm::Frame& frame) {
    Words words;
    words.water = print("%u particles", frame.count);
    const shm::Diagnostics& d = frame.diagnostics;
    if (!std::isnan(d.mean_density_error)) words.health = print(", error %.3f %%", 100 * d.mean_density_error);
    if (d.sub_steps > 0) {
        words.more = print(", %u+%u iterations", d.divergence_iterations, d.density_iterations);
    } else if (!std::isnan(d.mean_depth_m)) {
        words.more = print(", depth %.2f m", d.mean_depth_m);
    }
    return words;
}

std::size_t indoors(const CrowdWorld& crowd) {
    return crowd.indoors.inside + crowd.indoors.upstairs;
}

}  // namespace

std::string progress_line(const CrowdWorld& crowd, const shm::Frame& frame, double pace, std::optional<double> left) {
    const double time = time_of(crowd);
    Words words = words_of_water(frame);
    words.begin = print("t %.1f/%g s  active %zu arrived %zu dead %zu", time, crowd.scene.duration, crowd.active.size(),
                        crowd.arrived, crowd.dead);
    if (crowd.scene.site) words.begin += print(" sheltered %zu indoors %zu", crowd.sheltered, indoors(crowd));
    if (pace > 0 && left) words.pace = print("  %.2f x real, ", pace) + duration_text(*left) + " to go";
    return words.line();
}

std::string progress_line(const CrowdsProgress& crowds, const shm::Frame& frame, double pace) {
    Words words = words_of_water(frame);
    words.begin = print("t %.1f s  %zu of %zu crowds walk, %zu agents", crowds.time, crowds.walking, crowds.crowds,
                        crowds.active);
    if (pace > 0) words.pace = print("  %.2f x real time", pace);
    return words.line();
}

std::string summary_text(const CrowdWorld& crowd, const RunSummary& summary, double wall_time) {
    const double time = time_of(crowd);
    std::string text = print("%s: %zu of %zu arrived", summary.status.c_str(), crowd.arrived, crowd.agents.size());
    if (crowd.arrived > 0)
        text += print(", the last after %.1f s", static_cast<double>(crowd.last_arrival_step) * crowd.dt);
    if (crowd.scene.site) text += print(", %zu sheltered, %zu indoors", crowd.sheltered, indoors(crowd));
    text += print("; %zu dead, %zu active", crowd.dead, crowd.active.size());
    if (const std::size_t standing = count_standing(crowd); standing > 0)
        text += print(", %zu of them stand", standing);
    text += "\n";
    if (const std::string deep = warning_of_deep_water(crowd); !deep.empty()) text += "warning: " + deep + "\n";
    text += print("%.1f s simulated in %.1f s of wall time", time, wall_time);
    if (wall_time > 0) text += print(" (%.2f s a second)", time / wall_time);
    if (summary.dropped_frames > 0) {
        text += print("; %llu frames taken, %llu dropped", static_cast<unsigned long long>(summary.frames),
                      static_cast<unsigned long long>(summary.dropped_frames));
    }
    const FluidSummary& fluid = summary.fluid;
    text += print("\nwater: up to %u particles", fluid.particles_max);
    if (const auto error = fluid.density_error.value()) text += print(", mean density error %.3f %%", 100 * *error);
    if (fluid.steps > 0)
        text += print(", %llu position clamps", static_cast<unsigned long long>(fluid.position_clamps));
    if (fluid.resident_bytes > 0)
        text += print(", server memory %.0f MB", static_cast<double>(fluid.resident_bytes) * 1e-6);
    return text;
}

std::string step_times_text(const CrowdWorld& crowd) {
    if (!crowd.times || crowd.times->steps == 0) return "";
    std::string text = "microseconds a step:";
    const std::vector<std::string_view> names = stage_names();
    const double per_step = 1e6 / static_cast<double>(crowd.times->steps);
    for (std::size_t i = 0; i < names.size() && i < crowd.times->seconds.size(); ++i) {
        text += print("\n  %8.1f  ", per_step * crowd.times->seconds[i]) + std::string(names[i]);
    }
    return text;
}

}  // namespace wade::crowd
