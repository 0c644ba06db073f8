#include "shm_protocol/inside/link.hpp"

#include "shm_protocol/inside/atomic.hpp"
#include "shm_protocol/inside/futex.hpp"
#include "shm_protocol/inside/liveness.hpp"

namespace wade::shm {

void Link::ring() const {
    count_up(doorbell->consumer_sequence);
    if (load_ordered(pages.control().producer_waiting) != 0) futex_wake_all(doorbell->consumer_sequence);
}

void Link::heartbeat() const noexcept {
    if (gone) return;  // the entry may have another owner by now
    store_relaxed(entry->heartbeat_ns, static_cast<std::uint64_t>(monotonic_ns()));
}

void Link::set_paused(bool paused) const noexcept {
    if (!gone) store_release(entry->paused, paused ? 1U : 0U);
}

// After ring(), so that the frame is read when the goodbye can be seen.
void Link::lay_to_rest() const noexcept {
    store_release(entry->left_at_frame, load_ordered(pages.control().published_frame));
}

void Link::say_goodbye(ConsumerState last, int reason_code, std::string_view text) noexcept {
    if (gone) return;
    gone = true;
    entry->reason_code = reason_code;
    store_text(entry->reason_text, reason_bytes, text);
    store_release(entry->state, static_cast<std::uint32_t>(last));
    ring();
    lay_to_rest();
    unlock_byte(file.fd(), consumer_lock_byte + index);
    ring();  // a producer believes the goodbye once the lock is free
}

void Link::check_entry(std::uint64_t acknowledged) const {
    const auto demand = [this](const char* word, std::uint64_t wrote, std::uint64_t reads) {
        if (wrote == reads) return;
        throw Error(
            Failure::protocol_violation,
            std::string("Another process has written into this consumer's page of the shared-memory segment: ") + word +
                " is " + std::to_string(reads) + ", it was " + std::to_string(wrote) + ".");
    };
    demand("state", consumer_joined, load_acquire(entry->state));
    demand("mode", mode, load_relaxed(entry->mode));
    demand("flags", flags, load_relaxed(entry->flags));
    demand("acknowledged_frame", acknowledged, load_acquire(entry->acknowledged_frame));
}

bool Link::producer_lives() const {
    return is_locked_by_other(file.fd(), producer_lock_byte);
}

std::string Link::producer() const {
    return "Producer '" + map->info.producer_name + "' (process " + std::to_string(producer_pid) + ")";
}

std::string Link::next_frame() const {
    const Control& control = pages.control();
    const auto silent_ms = (monotonic_ns() - static_cast<std::int64_t>(load_relaxed(control.heartbeat_ns))) / 1'000'000;
    return "frame " + std::to_string(load_acquire(control.published_frame) + 1) + " of producer '" +
           map->info.producer_name + "' (process " + std::to_string(producer_pid) + ", alive, last sign of life " +
           std::to_string(silent_ms) + " ms ago)";
}

Error Link::producer_gave_up() const {
    const Control& control = pages.control();
    return {Failure::peer_aborted, producer() + " gave up at frame " +
                                       std::to_string(load_acquire(control.published_frame) + 1) + ": " +
                                       printable(control.reason_text, reason_bytes)};
}

Error Link::producer_died() const {
    const std::uint64_t published = load_acquire(pages.control().published_frame);
    return {Failure::peer_dead, producer() + " died at frame " + std::to_string(published + 1) +
                                    "; the last complete frame is " + std::to_string(published) + "."};
}

Error Link::ended_before_entry() const {
    return {Failure::attach_timeout, producer() + " ended its stream before consumer '" +
                                         printable(entry->name, name_bytes) + "' could take part."};
}

Sleep Link::bed() const {
    return {pages.control().publish_sequence, entry->waiting, entry->paused};
}

}  // namespace wade::shm
