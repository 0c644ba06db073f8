#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "configs/loading/scene_loader.hpp"
#include "tools/shm/observer.hpp"

namespace wade {
namespace {

[[gnu::format(printf, 1, 2)]] std::string print(const char* format, ...) {
    char buffer[1024];
    std::va_list values;
    va_start(values, format);
    std::vsnprintf(buffer, sizeof buffer, format, values);
    va_end(values);
    return buffer;
}

unsigned long long ull(std::uint64_t value) {
    return value;
}

std::string participant(const std::string& name, std::uint32_t pid, const char* life) {
    return "'" + name + "' (process " + std::to_string(pid) + life + ")";
}

const char* life(bool alive) {
    return alive ? ", alive" : ", dead";
}

std::string doing(bool waiting, bool paused, double silent_s) {
    return std::string(paused    ? ", paused"
                       : waiting ? ", waiting"
                                 : "") +
           print(", last sign of life %.1f s ago", silent_s);
}

std::string frame_line(const Sample& sample) {
    const SegmentView& s = sample.segment;
    std::string text = print("  frame %llu", ull(s.published_frame));
    if (s.last) {
        const shm::SlotDescriptor& d = *s.last;
        text += print(", %.3f s, %u %s", static_cast<double>(d.tick) / static_cast<double>(s.info.ticks_per_second),
                      d.count, s.info.kind == shm::stream_agents ? "agents" : "particles");
        if (d.hash != 0) text += ", hash " + hash_text(d.hash);
    }
    if (sample.frames_per_s)
        text += print("; %.1f frames/s, %.2f x real time", *sample.frames_per_s,
                      times_real_time(s.info, *sample.frames_per_s));
    return text + "\n";
}

std::string diagnostics_line(const shm::Diagnostics& d) {
    std::string text;
    const auto add = [&](const std::string& part) { text += (text.empty() ? "  " : ", ") + part; };
    if (std::isfinite(d.mean_density_error))
        add(print("density error %.3f %% (max %.2f %%)", 100 * d.mean_density_error, 100 * d.max_density_error));
    if (std::isfinite(d.last_dt_s)) add(print("last dt %.5f s", d.last_dt_s));
    if (d.sub_steps != 0) add(print("%u sub-steps", d.sub_steps));
    if (std::isfinite(d.mean_depth_m)) add(print("depth %.2f m", d.mean_depth_m));
    if (std::isfinite(d.mean_speed_m_s)) add(print("%.2f m/s", d.mean_speed_m_s));
    if (d.solver_ns != 0) add(print("solver %.1f ms", 1e-6 * static_cast<double>(d.solver_ns)));
    return text.empty() ? text : text + "\n";
}

std::string consumer_line(const SegmentView& s, const ConsumerView& c) {
    const std::string who = "  consumer " + std::to_string(c.index) + " ";
    if (c.state != shm::consumer_joined)
        return who + participant(c.name, c.pid, "") + " " + consumer_state_word(c.state) +
               (c.reason.empty() ? "" : ": " + c.reason) + "\n";
    std::string text = who + participant(c.name, c.pid, life(c.alive));
    text += c.mode == shm::mode_latest ? " latest" : c.follows ? " lockstep, follower" : " lockstep";
    if (c.admitted_frame == 0) {
        text += ", not admitted yet";
    } else if (c.mode == shm::mode_latest) {
        text += print(", took frame %llu, dropped %llu, stride %u", ull(c.acknowledged_frame), ull(c.dropped_frames),
                      c.stride);
    } else {
        text += print(", since frame %llu, %llu behind", ull(c.admitted_frame), ull(frames_behind(s, c)));
    }
    return text + doing(c.waiting, c.paused, c.silent_s) + "\n";
}

}  // namespace

std::string text_of(const Sample& sample) {
    const SegmentView& s = sample.segment;
    std::string text = s.name + "  " + (s.condition == Condition::readable ? "" : s.problem + "; ");
    if (!was_opened(s.condition)) return s.name + "  " + s.problem + "\n";
    const std::string file = print("%.2f MB, mode %04o, user %u", 1e-6 * static_cast<double>(s.bytes), s.mode, s.owner);
    if (s.condition != Condition::readable)
        return text + "its producer is " + (s.producer_alive ? "alive" : "dead") + " (" + file + ")\n";

    const shm::StreamInfo& info = s.info;
    text += producer_state_word(s.state) + ", producer " +
            participant(info.producer_name, s.pid, life(s.producer_alive)) + doing(s.waiting, s.paused, s.silent_s) +
            "\n";
    if (!s.reason.empty()) text += "  gave up with code " + std::to_string(s.reason_code) + ": " + s.reason + "\n";
    text +=
        print("  contract %u.%u, %s; scene %s; capacity %u, depth %u of %u slots, %.6g frames/s of simulated time\n",
              s.version_major, s.version_minor, file.c_str(),
              info.scene_hash == 0 ? "not given" : hash_text(info.scene_hash).c_str(), info.capacity, info.depth,
              info.slots, static_cast<double>(info.ticks_per_second) / static_cast<double>(info.ticks_per_frame));
    text += frame_line(sample);
    if (s.last) text += diagnostics_line(s.last->diagnostics);
    for (const ConsumerView& c : s.consumers) text += consumer_line(s, c);
    if (s.consumers.empty()) text += "  no consumer has joined\n";
    return text;
}

}  // namespace wade
