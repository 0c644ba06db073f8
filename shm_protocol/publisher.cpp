#include "shm_protocol/publisher.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "shm_protocol/inside/atomic.hpp"
#include "shm_protocol/inside/bytes/hash.hpp"
#include "shm_protocol/inside/frame_check.hpp"
#include "shm_protocol/inside/futex.hpp"
#include "shm_protocol/inside/publisher_state.hpp"

namespace wade::shm {
namespace {

// Records why the stream cannot go on; attached consumers learn the reason when the publisher goes.
template <typename State, typename Work>
auto explained(State& state, Work&& work) {
    try {
        return work();
    } catch (const Error& error) {
        state.reason = error.what();
        state.reason_code = error.exit_code();
        throw;
    }
}

template <typename State>
void demand_running(const State& state, const char* call) {
    if (state.ended) throw std::logic_error(std::string("Publisher::") + call + " after the end of the stream");
}

}  // namespace

Publisher::Publisher(const std::string& session, StreamInfo info, Waiting waiting)
    : state_(std::make_unique<PublisherState>(session, info, std::move(waiting))) {}

Publisher::~Publisher() {
    if (state_) abort(state_->reason_code, state_->reason);
}

Publisher::Publisher(Publisher&&) noexcept = default;

Publisher& Publisher::operator=(Publisher&& other) noexcept {
    if (this != &other) {
        if (state_) abort(state_->reason_code, state_->reason);
        state_ = std::move(other.state_);
    }
    return *this;
}

const StreamInfo& Publisher::info() const {
    return state_->map.info;
}
std::uint64_t Publisher::published_frames() const {
    return state_->published;
}
std::uint64_t Publisher::frame_hash() const {
    return state_->chain;
}

void Publisher::heartbeat() noexcept {
    store_relaxed(state_->pages.control().heartbeat_ns, static_cast<std::uint64_t>(monotonic_ns()));
}

void Publisher::set_paused(bool paused) noexcept {
    if (!state_->ended) store_release(state_->pages.control().paused, paused ? 1U : 0U);
}

bool Publisher::consumers_are_there() const {
    return state_->consumers_are_there();
}

bool Publisher::check_consumers() {
    PublisherState& s = *state_;
    return explained(s, [&] {
        const PublisherState::Census census = s.survey(0);
        s.check_alive(std::numeric_limits<std::uint64_t>::max());
        return census.active > 0 || !s.had_lockstep;
    });
}

void Publisher::wait_for_consumers(int n) {
    PublisherState& s = *state_;
    demand_running(s, "wait_for_consumers");
    if (s.published > 0 || s.frame_open)
        throw std::logic_error("Publisher::wait_for_consumers after frame 1 was begun");
    if (n < 1 || n > static_cast<int>(s.map.consumer_count))
        throw std::invalid_argument("Publisher::wait_for_consumers(" + std::to_string(n) + "): 1 to 16 are possible.");
    s.refusals_count = true;
    PublisherState::Census census;
    explained(s, [&] {
        WaitTask task;
        task.ready = [&] {
            census = s.survey(1);
            return census.joined >= n && census.active > 0;
        };
        task.after_slice = [&] {
            heartbeat();
            s.check_alive(1);
        };
        task.what = [&] {
            return std::to_string(n) + (n == 1 ? " consumer" : " consumers") + " to join the stream of " +
                   (s.map.info.kind == stream_agents ? "agents" : "water") + " of session '" + s.session + "' (" +
                   std::to_string(census.joined) + " did" +
                   (census.joined > 0 && census.active == 0 ? ", followers only)" : ")");
        };
        task.on_timeout = Failure::attach_timeout;
        task.timeout_s = s.waiting.attach_timeout_s;
        s.wait(task);
    });
    s.refusals_count = false;
}

std::optional<FrameFields> Publisher::begin_frame() {
    PublisherState& s = *state_;
    demand_running(s, "begin_frame");
    if (s.frame_open) throw std::logic_error("Publisher::begin_frame twice without end_frame");
    if (s.sent_final) throw std::logic_error("Publisher::begin_frame after the final frame");
    const std::uint64_t frame = s.published + 1;
    const std::uint64_t depth = s.map.info.depth;
    const std::uint64_t owed = frame > depth ? frame - depth : 0;
    heartbeat();
    PublisherState::Census census;
    explained(s, [&] {
        if (s.state == producer_ready) s.enter(producer_running);
        WaitTask task;
        task.ready = [&] {
            census = s.survey(frame);
            return census.slowest >= owed || (census.active == 0 && s.had_lockstep);
        };
        task.after_slice = [&] {
            heartbeat();
            s.check_alive(owed);
        };
        task.what = [&] { return s.everybody_behind(owed); };
        task.paused = [&] { return s.waits_for_paused(owed); };
        task.timeout_s = s.waiting.step_timeout_s;
        task.warning_s = s.waiting.step_warning_s;
        s.wait(task);
    });
    if (census.active == 0 && s.had_lockstep) return std::nullopt;

    SlotDescriptor& descriptor = s.pages.descriptor(frame);
    store_ordered(descriptor.sequence, 2 * frame - 1);
    fence_release();
    s.frame_open = true;
    const std::size_t capacity = s.map.info.capacity;
    const auto array = [&](std::size_t i) { return std::span<float>(s.pages.field(frame, i), capacity); };
    FrameFields fields;
    fields.frame = frame;
    fields.mass = array(0);
    fields.vx = array(1);
    fields.vy = array(2);
    fields.vz = array(3);
    fields.px = array(4);
    fields.py = array(5);
    fields.pz = array(6);
    if (s.map.info.kind == stream_agents) {
        fields.radius = array(7);
        fields.height = array(8);
        fields.state = array(9);
    }
    if (s.map.info.impulses) {
        fields.jx = array(10);
        fields.jz = array(11);
        fields.submerged = array(12);
        fields.spread = array(13);
    }
    return fields;
}

void Publisher::end_frame(std::uint32_t count, const Diagnostics& diagnostics, bool final,
                          std::optional<std::uint64_t> given_tick) {
    PublisherState& s = *state_;
    demand_running(s, "end_frame");
    if (!s.frame_open) throw std::logic_error("Publisher::end_frame without begin_frame");
    const std::uint64_t frame = s.published + 1;
    if (count > s.map.info.capacity)
        throw std::invalid_argument("Frame " + std::to_string(frame) + " holds " + std::to_string(count) +
                                    " particles, the capacity is " + std::to_string(s.map.info.capacity) + ".");
    const std::uint64_t tick = given_tick.value_or(tick_of_frame(s.map.info, frame));
    const auto before = s.published > 0 ? std::optional<FrameTick>({s.published, s.last_tick}) : std::nullopt;
    if (const std::string fault = tick_fault(s.map.info, {frame, tick}, final, before); !fault.empty())
        throw std::invalid_argument("Frame " + std::to_string(frame) + " " + fault + ".");

    SlotDescriptor& descriptor = s.pages.descriptor(frame);
    descriptor.frame = frame;
    descriptor.tick = tick;
    descriptor.count = count;
    descriptor.flags = final ? frame_final : 0U;
    descriptor.hash = descriptor.further_hash = 0;
    descriptor.previous_hash = s.chain;
    descriptor.diagnostics = diagnostics;
    if (s.hash_frames) {
        std::array<std::span<const float>, max_fields> fields;
        const std::size_t n = s.map.fields.size();
        for (std::size_t i = 0; i < n; ++i) fields[i] = {s.pages.field(frame, i), count};
        const std::size_t required = required_fields(s.map.info.kind).size();
        const ChainResult result = chain_frame(s.chain, frame, std::span(fields).first(required));
        if (result.nonfinite) descriptor.flags |= frame_nonfinite;
        s.chain = descriptor.hash = result.hash;
        if (n > required) {
            const ChainResult further = chain_frame(s.chain, frame, std::span(fields).first(n).subspan(required));
            if (further.nonfinite) descriptor.flags |= frame_nonfinite;
            descriptor.further_hash = further.hash;
        }
    }
    descriptor.crc32c = descriptor_crc(descriptor);
    store_release(descriptor.sequence, 2 * frame);
    store_release(s.pages.control().published_frame, frame);
    s.published = frame;
    s.last_tick = tick;
    s.frame_open = false;
    s.sent_final = final;
    heartbeat();
    if (final)
        s.enter(producer_draining);
    else
        s.ring();
}

void Publisher::close() {
    PublisherState& s = *state_;
    if (s.ended) return;
    explained(s, [&] {
        s.enter(producer_draining);
        WaitTask task;
        task.ready = [&] { return s.survey(0).slowest >= s.published; };
        task.after_slice = [&] {
            heartbeat();
            s.check_alive(s.published);
        };
        task.what = [&] { return s.everybody_behind(s.published); };
        task.paused = [&] { return s.waits_for_paused(s.published); };
        task.timeout_s = s.waiting.step_timeout_s;
        task.warning_s = s.waiting.step_warning_s;
        s.wait(task);
    });
    s.end(producer_closed);
}

void Publisher::abort(int reason_code, std::string_view text) noexcept {
    PublisherState& s = *state_;
    if (s.ended) return;
    Control& control = s.pages.control();
    control.reason_code = reason_code;
    store_text(control.reason_text, reason_bytes, text);
    s.end(producer_aborted);
}

}  // namespace wade::shm
