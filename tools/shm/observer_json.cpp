#include <cmath>

#include "configs/json/json.hpp"
#include "configs/loading/scene_loader.hpp"
#include "tools/shm/observer.hpp"

namespace wade {
namespace {

Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json json_of(const shm::SlotDescriptor& d, const shm::StreamInfo& info) {
    const shm::Diagnostics& q = d.diagnostics;
    return {{"frame", d.frame},
            {"time_s", static_cast<double>(d.tick) / static_cast<double>(info.ticks_per_second)},
            {"tick", d.tick},
            {"particles", d.count},
            {"final", (d.flags & shm::frame_final) != 0},
            {"nonfinite", (d.flags & shm::frame_nonfinite) != 0},
            {"hash", d.hash == 0 ? Json(nullptr) : Json(hash_text(d.hash))},
            {"sub_steps", q.sub_steps},
            {"last_dt_s", number(q.last_dt_s)},
            {"mean_density_error", number(q.mean_density_error)},
            {"max_density_error", number(q.max_density_error)},
            {"solver_s", 1e-9 * static_cast<double>(q.solver_ns)},
            {"mean_depth_m", number(q.mean_depth_m)},
            {"mean_speed_m_s", number(q.mean_speed_m_s)},
            {"resident_bytes", q.resident_bytes}};
}

Json json_of(const ConsumerView& c, const SegmentView& s) {
    return {{"index", c.index},
            {"name", c.name},
            {"pid", c.pid},
            {"alive", c.alive},
            {"state", consumer_state_word(c.state)},
            {"mode", c.mode == shm::mode_latest ? "latest" : "lockstep"},
            {"stride", c.stride},
            {"follows", c.follows},
            {"waiting", c.waiting},
            {"paused", c.paused},
            {"admitted_frame", c.admitted_frame},
            {"acknowledged_frame", c.acknowledged_frame},
            {"frames_behind", frames_behind(s, c)},
            {"dropped_frames", c.dropped_frames},
            {"silent_s", c.silent_s},
            {"reason", c.reason.empty() ? Json(nullptr) : Json(c.reason)}};
}

Json json_of(const Sample& sample) {
    const SegmentView& s = sample.segment;
    Json json = {{"segment", s.name}, {"condition", word_for(s.condition)}};
    if (!s.problem.empty()) json["problem"] = s.problem;
    if (!was_opened(s.condition)) return json;
    json["producer_alive"] = s.producer_alive;
    json["owner_uid"] = s.owner;
    json["mode"] = s.mode;
    json["bytes"] = s.bytes;
    if (s.condition != Condition::readable) return json;
    const shm::StreamInfo& info = s.info;
    const auto& last = s.last;
    json["version"] = std::to_string(s.version_major) + "." + std::to_string(s.version_minor);
    json["session_id"] = hash_text(info.session_id);
    json["scene_hash"] = info.scene_hash == 0 ? Json(nullptr) : Json(hash_text(info.scene_hash));
    json["kind"] = info.kind == shm::stream_agents ? "agents" : "fluid";
    json["coupling_lag"] = info.coupling_lag;
    json["capacity"] = info.capacity;
    json["depth"] = info.depth;
    json["slots"] = info.slots;
    json["ticks_per_second"] = info.ticks_per_second;
    json["ticks_per_frame"] = info.ticks_per_frame;
    json["metres_per_unit"] = info.metres_per_unit;
    json["producer"] = {{"name", info.producer_name},
                        {"pid", s.pid},
                        {"state", producer_state_word(s.state)},
                        {"waiting", s.waiting},
                        {"paused", s.paused},
                        {"silent_s", s.silent_s},
                        {"reason_code", s.reason_code},
                        {"reason", s.reason.empty() ? Json(nullptr) : Json(s.reason)}};
    json["published_frame"] = s.published_frame;
    json["frames_per_s"] = sample.frames_per_s ? number(*sample.frames_per_s) : Json(nullptr);
    json["times_real_time"] = sample.frames_per_s ? number(times_real_time(info, *sample.frames_per_s)) : Json(nullptr);
    json["last_frame"] = last ? json_of(*last, info) : Json(nullptr);
    json["consumers"] = Json::array();
    for (const ConsumerView& c : s.consumers) json["consumers"].push_back(json_of(c, s));
    return json;
}

}  // namespace

std::string json_of(const std::vector<Sample>& samples, bool pretty) {
    Json all = Json::array();
    for (const Sample& sample : samples) all.push_back(json_of(sample));
    return all.dump({.indent = pretty ? 2 : -1, .lossy_text = true}) + "\n";
}

}  // namespace wade
