#include "shm_protocol/subscriber.hpp"

#include <stdexcept>
#include <utility>

#include "shm_protocol/inside/atomic.hpp"
#include "shm_protocol/inside/bytes/hash.hpp"
#include "shm_protocol/inside/futex.hpp"
#include "shm_protocol/inside/liveness.hpp"
#include "shm_protocol/inside/publisher_state.hpp"
#include "shm_protocol/inside/subscriber_state.hpp"
#include "shm_protocol/publisher.hpp"

namespace wade::shm {

Subscriber::Subscriber(const std::string& session, const std::string& consumer_name, JoinOptions options)
    : state_(std::make_unique<SubscriberState>(attach({session, consumer_name, options}), options)) {}

Subscriber Subscriber::in_process(Publisher& publisher, const std::string& consumer_name, JoinOptions options) {
    const PublisherState& p = *publisher.state_;
    options.kind = p.map.info.kind;
    auto* const base = static_cast<std::byte*>(p.region.get_address());
    return Subscriber(std::make_unique<SubscriberState>(
        attach({p.session, consumer_name, options, mode_lockstep, 1, base}), options));
}

void Subscriber::refuse(const std::string& session, const std::string& consumer_name, const JoinOptions& options,
                        int reason_code, const std::string& text) {
    attach({session, consumer_name, options, mode_lockstep, 1, nullptr, Refusal{reason_code, text}});
}

Subscriber::Subscriber(std::unique_ptr<SubscriberState> state) : state_(std::move(state)) {}

Subscriber::~Subscriber() {
    if (state_) state_->finish();
}

Subscriber::Subscriber(Subscriber&&) noexcept = default;

Subscriber& Subscriber::operator=(Subscriber&& other) noexcept {
    if (this != &other) {
        if (state_) state_->finish();
        state_ = std::move(other.state_);
    }
    return *this;
}

const StreamInfo& Subscriber::info() const {
    return state_->link.map->info;
}
std::uint64_t Subscriber::released_frame() const {
    return state_->released;
}
void Subscriber::heartbeat() noexcept {
    state_->link.heartbeat();
}
void Subscriber::set_paused(bool paused) noexcept {
    state_->link.set_paused(paused);
}

std::optional<Frame> Subscriber::acquire() {
    SubscriberState& s = *state_;
    if (s.held != 0) throw std::logic_error("Subscriber::acquire twice without release");
    if (s.failure) throw Error(*s.failure);
    if (s.over) return std::nullopt;
    try {
        if (!s.wait_for_next()) {
            s.over = true;
            return std::nullopt;
        }
        Frame frame = s.check_frame();
        s.held = frame.frame;
        s.held_is_final = frame.final;
        return frame;
    } catch (const Error& error) {
        s.failure = error;
        abort(error.exit_code(), error.what());
        throw;
    }
}

void Subscriber::release() {
    SubscriberState& s = *state_;
    if (s.held == 0) throw std::logic_error("Subscriber::release without acquire");
    if (load_acquire(s.link.pages.descriptor(s.held).sequence) != 2 * s.held) {
        const Error error(Failure::protocol_violation,
                          s.link.producer() + " overwrote frame " + std::to_string(s.held) + " while it was in use.");
        s.failure = error;
        abort(error.exit_code(), error.what());
        throw error;
    }
    s.link.heartbeat();
    store_release(s.link.entry->acknowledged_frame, s.held);
    s.released = s.held;
    s.next = s.held + 1;
    s.over = s.held_is_final;
    s.held = 0;
    s.link.ring();
}

bool Subscriber::producer_is_there() const {
    return state_->link.producer_lives();
}

void Subscriber::leave() noexcept {
    state_->say_goodbye(consumer_left, 0, "");
}

void Subscriber::abort(int reason_code, std::string_view text) noexcept {
    state_->say_goodbye(consumer_aborted, reason_code, text);
}

}  // namespace wade::shm
