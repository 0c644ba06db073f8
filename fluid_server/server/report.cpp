#include "fluid_server/server/report.hpp"

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <vector>

namespace wade::fluid {

namespace {

using Count = unsigned long long;  // what printf knows

constexpr std::size_t columns = 100;  // of a line of progress

[[gnu::format(printf, 1, 2)]] std::string print(const char* format, ...) {
    char buffer[512];
    std::va_list values;
    va_start(values, format);
    std::vsnprintf(buffer, sizeof buffer, format, values);
    va_end(values);
    return buffer;
}

std::string speed_text(const ServerSummary& summary, double simulated, double wall) {
    std::string text = print("%.2f x real time", simulated / wall);
    if (summary.solver_time > 0) {
        text += print("; solver alone %.1f s, %.2f M particle-steps/s", summary.solver_time,
                      1e-6 * static_cast<double>(summary.particle_steps) / summary.solver_time);
    }
    return text;
}

std::string pace_text(const RunClock& clock, std::uint64_t frames_sent) {
    if (clock.pace() != Pace::real_time || frames_sent == 0) return {};
    if (clock.late_frames() == 0) return "; every frame sent on time";
    return print("; %llu frames sent late, by up to %.0f ms", Count{clock.late_frames()}, 1e3 * clock.worst_lateness());
}

std::string agents_text(const AgentsInlet* agents) {
    if (agents == nullptr) return {};
    return print("; %llu frames of agents taken, hash %016llx", Count{agents->frames()}, Count{agents->hash()});
}

}  // namespace

std::string progress_line(const ServerRun& run, const ServerSummary& summary, const TimeLeft& left) {
    const shm::Diagnostics& d = summary.last;
    // In their order; of what is too much for a line the last is left out first.
    std::vector<std::string> words{
        print("t %.1f/%.0f s  %u particles", run.clock.simulated(), run.clock.end(), summary.particles)};
    if (const auto seconds = left.seconds()) {
        words.push_back(print("  %.2f x real time, about ", left.pace()) + duration_text(*seconds) + " to go");
    }
    words.push_back(print("  dt %.4f s", d.last_dt_s));
    if (!std::isnan(d.mean_density_error)) {
        words.push_back(print("  density error %.3f %%", 100 * d.mean_density_error));
        words.push_back(print("  %u+%u iterations", d.divergence_iterations, d.density_iterations));
    }
    // A dry river has neither.
    if (!std::isnan(d.mean_depth_m)) words.push_back(print("  depth %.2f m", d.mean_depth_m));
    if (!std::isnan(d.mean_speed_m_s)) words.push_back(print("  %.2f m/s", d.mean_speed_m_s));
    std::string line;
    for (const std::string& word : words) {
        if (line.size() + word.size() > columns) break;
        line += word;
    }
    return line;
}

std::string summary_text(const ServerRun& run, const ServerSummary& summary, double wall) {
    if (summary.frames == 0) return print("no frame simulated in %.1f s of wall time", wall);
    const double time = run.clock.simulated();
    std::string text =
        print("%llu frames, %.1f simulated s in %.1f s of wall time (", Count{summary.frames}, time, wall);
    text += speed_text(summary, time, wall) + ")" + pace_text(run.clock, run.publisher.published_frames()) +
            agents_text(run.agents);
    if (summary.resident_bytes > 0)
        text += print("; memory %.0f MB", 1e-6 * static_cast<double>(summary.resident_bytes));
    if (!std::isnan(summary.last.driving_acceleration_m_s2)) {
        text += print("; mean driving acceleration %.2e m/s2", summary.driving_impulse / time);
    }
    if (summary.last.recycled_particles > 0) {
        text += print("; %llu particles recycled", Count{summary.last.recycled_particles});
    }
    if (summary.last.position_clamps > 0) text += print("; %llu position clamps", Count{summary.last.position_clamps});
    if (const std::string remarks = run.model.remarks(); !remarks.empty()) text += "; " + remarks;
    if (summary.crowd_left) {
        text += print("; the crowd said goodbye before frame %llu was sent, %.1f s before the end",
                      Count{run.publisher.published_frames() + 1}, run.clock.end() - time);
    }
    return text;
}

}  // namespace wade::fluid
