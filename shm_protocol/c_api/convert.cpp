#include "shm_protocol/c_api/convert.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <stdexcept>

#include "shm_protocol/inside/header.hpp"

namespace wade::shm::c_api {
namespace {

std::atomic<bool> interrupt_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free);  // a signal handler stores it

static_assert(sizeof(wade_diagnostics) == sizeof(Diagnostics));
static_assert(offsetof(wade_diagnostics, solver_ns) == offsetof(Diagnostics, solver_ns));
static_assert(offsetof(wade_diagnostics, resident_bytes) == offsetof(Diagnostics, resident_bytes));
static_assert(sizeof(wade_stream::producer_name) == name_bytes);

}  // namespace

void set_interrupt(bool on) noexcept {
    interrupt_asked = on;
}

StreamInfo from_c(const wade_stream& stream) {
    if (std::memchr(stream.producer_name, 0, name_bytes) == nullptr)
        throw std::invalid_argument("wade_stream::producer_name has no terminating zero.");
    StreamInfo info;
    info.producer_name = stream.producer_name;
    info.kind = static_cast<StreamKind>(stream.kind);
    info.capacity = stream.capacity;
    info.depth = stream.depth;
    info.slots = stream.slots;
    info.ticks_per_second = stream.ticks_per_second;
    info.ticks_per_frame = stream.ticks_per_frame;
    info.metres_per_unit = stream.metres_per_unit;
    std::copy_n(stream.origin, 3, info.origin.begin());
    std::copy_n(stream.axes, 3, info.axes.begin());
    info.coupling_lag = stream.coupling_lag;
    info.particle_radius = stream.particle_radius;
    info.rest_density = stream.rest_density;
    std::copy_n(stream.column_width, 2, info.column_width.begin());
    info.scene_hash = stream.scene_hash;
    info.hash_frames = stream.hash_frames != 0;
    info.group_access = stream.group_access != 0;
    return info;
}

Waiting from_c(const wade_waiting* given) {
    Waiting waiting;
    waiting.interrupted = [] { return interrupt_asked.load(); };
    if (given == nullptr) return waiting;
    const wade_waiting w = *given;
    waiting.attach_timeout_s = w.attach_timeout_s;
    waiting.step_warning_s = w.step_warning_s;
    waiting.step_timeout_s = w.step_timeout_s;
    if (w.interrupted != nullptr)
        waiting.interrupted = [w] { return interrupt_asked.load() || w.interrupted(w.context) != 0; };
    if (w.warn != nullptr) waiting.warn = [w](const std::string& text) { w.warn(text.c_str(), w.context); };
    return waiting;
}

JoinOptions from_c(const wade_join* given) {
    JoinOptions options;
    options.waiting = from_c(given == nullptr ? nullptr : &given->waiting);
    if (given == nullptr) return options;
    if (given->kind != stream_fluid && given->kind != stream_agents)
        throw std::invalid_argument("wade_join::kind = " + std::to_string(given->kind) + " is out of range: 1 or 2.");
    options.scene_hash = given->scene_hash;
    options.kind = static_cast<StreamKind>(given->kind);
    options.follows = given->follows != 0;
    options.group_access = given->group_access != 0;
    return options;
}

Diagnostics from_c(const wade_diagnostics* diagnostics) {
    return diagnostics == nullptr ? Diagnostics{} : std::bit_cast<Diagnostics>(*diagnostics);
}

wade_stream to_c(const StreamInfo& info) {
    wade_stream stream{};
    store_text(stream.producer_name, name_bytes, info.producer_name);
    stream.kind = info.kind;
    stream.capacity = info.capacity;
    stream.depth = info.depth;
    stream.slots = info.slots;
    stream.ticks_per_second = info.ticks_per_second;
    stream.ticks_per_frame = info.ticks_per_frame;
    stream.metres_per_unit = info.metres_per_unit;
    std::copy_n(info.origin.begin(), 3, stream.origin);
    std::copy_n(info.axes.begin(), 3, stream.axes);
    stream.coupling_lag = info.coupling_lag;
    stream.particle_radius = info.particle_radius;
    std::copy_n(info.column_width.begin(), 2, stream.column_width);
    stream.rest_density = info.rest_density;
    stream.scene_hash = info.scene_hash;
    stream.session_id = info.session_id;
    stream.hash_frames = info.hash_frames ? 1 : 0;
    stream.group_access = info.group_access ? 1 : 0;
    return stream;
}

wade_slot to_c(const FrameFields& f) {
    return {f.frame,     f.mass.size(), f.mass.data(), f.vx.data(),     f.vy.data(),     f.vz.data(),
            f.px.data(), f.py.data(),   f.pz.data(),   f.radius.data(), f.height.data(), f.state.data()};
}

wade_slot_impulses impulses_to_c(const FrameFields& f) {
    return {f.jx.data(), f.jz.data(), f.submerged.data(), f.spread.data()};
}

wade_frame_impulses impulses_to_c(const Frame& f) {
    return {f.jx.data(), f.jz.data(), f.submerged.data(), f.spread.data()};
}

wade_frame to_c(const Frame& f) {
    return {f.frame,           f.tick,          f.hash,         f.count,
            f.final ? 1U : 0U, f.mass.data(),   f.vx.data(),    f.vy.data(),
            f.vz.data(),       f.px.data(),     f.py.data(),    f.pz.data(),
            f.radius.data(),   f.height.data(), f.state.data(), std::bit_cast<wade_diagnostics>(f.diagnostics)};
}

}  // namespace wade::shm::c_api
