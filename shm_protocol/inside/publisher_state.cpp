#include "shm_protocol/inside/publisher_state.hpp"

#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "shm_protocol/inside/atomic.hpp"
#include "shm_protocol/inside/futex.hpp"
#include "shm_protocol/inside/liveness.hpp"

namespace wade::shm {
namespace {

std::uint64_t random_id() {
    std::uint64_t id = 0;
    while (id == 0) {
        const ssize_t got = getrandom(&id, sizeof id, 0);
        if (got < 0 && errno != EINTR) throw std::system_error(errno, std::generic_category(), "getrandom");
    }
    return id;
}

}  // namespace

PublisherState::PublisherState(const std::string& session_name, const StreamInfo& info, Waiting how)
    : session(session_name), name(segment_name(session_name, info.kind)), waiting(std::move(how)) {
    check_waiting(waiting);
    hash_frames = info.hash_frames;
    Header header = make_header(info, random_id());
    map = read_header(header, header.total_bytes);
    map.info.hash_frames = info.hash_frames;
    map.info.group_access = info.group_access;
    file = create_segment(name, header.total_bytes, info.group_access);
    try {
        region = file.map(0, header.total_bytes, true);
    } catch (...) {
        unlink_segment(file, name);
        throw;
    }
    auto* const base = static_cast<std::byte*>(region.get_address());
    pages = Pages<std::byte>(base, map);

    Control& control = pages.control();
    control.pid = static_cast<std::uint32_t>(getpid());
    control.start_time = process_start_time();
    store_relaxed(control.heartbeat_ns, static_cast<std::uint64_t>(monotonic_ns()));
    store_release(control.state, static_cast<std::uint32_t>(producer_ready));
    header.magic = 0;
    std::memcpy(base, &header, sizeof header);
    store_release(reinterpret_cast<Header*>(base)->magic, magic);
}

void PublisherState::admit(std::uint32_t i, std::uint64_t at) {
    const ConsumerEntry& entry = pages.consumer(i);
    members[i] = {at, load_relaxed(entry.mode), load_relaxed(entry.flags)};
    store_release(pages.control().admitted_frame[i], at);
}

void PublisherState::dismiss(std::uint32_t i) {
    members[i] = {};
    store_release(pages.control().admitted_frame[i], std::uint64_t{0});  // the entry may be used again
}

void PublisherState::check_words(std::uint32_t i, std::uint32_t consumer_state) const {
    const ConsumerEntry& entry = pages.consumer(i);
    const auto demand = [&](bool ok, const char* word, std::uint32_t value) {
        if (!ok)
            throw Error(Failure::protocol_violation, label(i) + " took part, and now its page says " + word + " = " +
                                                         std::to_string(value) + ": it was overwritten.");
    };
    demand(consumer_state >= consumer_joined && consumer_state <= consumer_aborted, "state", consumer_state);
    demand(load_relaxed(entry.mode) == members[i].mode, "mode", load_relaxed(entry.mode));
    demand(load_relaxed(entry.flags) == members[i].flags, "flags", load_relaxed(entry.flags));
}

void PublisherState::check_own_page() const {
    const Control& control = pages.control();
    if (load_relaxed(control.state) == state && load_relaxed(control.published_frame) == published) return;
    throw Error(Failure::protocol_violation, "Another process has written into the control page of " + name +
                                                 ": state " + std::to_string(load_relaxed(control.state)) +
                                                 ", published_frame " +
                                                 std::to_string(load_relaxed(control.published_frame)) + ".");
}

PublisherState::Census PublisherState::survey(std::uint64_t admit_at) {
    check_own_page();
    Census census;
    bool news = false;
    for (std::uint32_t i = 0; i < map.consumer_count; ++i) {
        const ConsumerEntry& entry = pages.consumer(i);
        const std::uint32_t consumer_state = load_acquire(entry.state);
        if (consumer_state == consumer_free && members[i].admitted == 0) continue;
        if (consumer_state == consumer_joined && members[i].admitted == 0 && admit_at != 0 &&
            load_relaxed(entry.mode) <= mode_latest) {
            admit(i, admit_at);
            news = true;
        }
        if (members[i].admitted != 0 && has_left(i, consumer_state)) {
            dismiss(i);
            continue;
        }
        if (members[i].in_lockstep()) check_words(i, consumer_state);
        const bool lockstep =
            members[i].admitted != 0 ? members[i].in_lockstep() : load_relaxed(entry.mode) == mode_lockstep;
        const bool before_start = refusals_count && published == 0;
        if (lockstep && ((consumer_state == consumer_aborted && (members[i].admitted != 0 || before_start)) ||
                         (consumer_state == consumer_refused && before_start)))
            throw Error(
                Failure::peer_aborted,
                label(i) +
                    (consumer_state == consumer_refused
                         ? " refused the stream: "
                         : " gave up at frame " + std::to_string(load_acquire(entry.acknowledged_frame) + 1) + ": ") +
                    printable(entry.reason_text, reason_bytes));
        if (!members[i].in_lockstep()) continue;
        const std::uint64_t acknowledged = load_acquire(entry.acknowledged_frame);
        if (acknowledged > published)
            throw Error(Failure::protocol_violation, label(i) + " acknowledged frame " + std::to_string(acknowledged) +
                                                         ", the last one published is " + std::to_string(published) +
                                                         ".");
        ++census.joined;
        if (!members[i].follows()) ++census.active;
        census.slowest = std::min(census.slowest, std::max(acknowledged, members[i].admitted - 1));
    }
    had_lockstep = had_lockstep || census.active > 0;
    if (news) ring();
    return census;
}

bool PublisherState::has_left(std::uint32_t i, std::uint32_t consumer_state) const {
    // The producer never waits for a free-running reader: any end of it is a goodbye, whatever the reason.
    const bool goodbye =
        consumer_state == consumer_left || (consumer_state == consumer_aborted && members[i].mode == mode_latest);
    return goodbye && !is_locked_by_other(file.fd(), consumer_lock_byte + i);
}

bool PublisherState::counts(std::uint32_t i) const {
    return members[i].in_lockstep() && !has_left(i, load_acquire(pages.consumer(i).state));
}

bool PublisherState::waits_for_paused(std::uint64_t frame) const {
    for (std::uint32_t i = 0; i < map.consumer_count; ++i) {
        const ConsumerEntry& entry = pages.consumer(i);
        if (counts(i) && load_acquire(entry.paused) != 0 && load_acquire(entry.acknowledged_frame) < frame) return true;
    }
    return false;
}

void PublisherState::check_alive(std::uint64_t owed) {
    for (std::uint32_t i = 0; i < map.consumer_count; ++i) {
        const ConsumerEntry& entry = pages.consumer(i);
        if (!counts(i)) continue;
        if (is_locked_by_other(file.fd(), consumer_lock_byte + i)) continue;
        // Whatever it did before it went is visible now: a goodbye, or the acknowledgement of all it owed.
        if (load_acquire(entry.state) != consumer_joined) continue;
        const std::uint64_t acknowledged = load_acquire(entry.acknowledged_frame);
        if (acknowledged >= owed) continue;
        const std::uint64_t died_at = std::max(acknowledged + 1, members[i].admitted);
        throw Error(Failure::peer_dead, label(i) + " died at frame " + std::to_string(died_at) + ".");
    }
}

bool PublisherState::consumers_are_there() const {
    bool somebody = !had_lockstep;
    for (std::uint32_t i = 0; i < map.consumer_count; ++i) {
        if (!members[i].in_lockstep()) continue;
        const bool locked = is_locked_by_other(file.fd(), consumer_lock_byte + i);
        // After the lock: a goodbye comes before it is given up.
        const std::uint32_t said = load_acquire(pages.consumer(i).state);
        if (said == consumer_aborted || (said == consumer_joined && !locked)) return false;
        somebody = somebody || locked;
    }
    return somebody;
}

void PublisherState::ring() {
    Control& control = pages.control();
    count_up(control.publish_sequence);
    for (std::uint32_t i = 0; i < map.consumer_count; ++i) {
        if (load_ordered(pages.consumer(i).waiting) == 0) continue;
        futex_wake_all(control.publish_sequence);
        break;
    }
}

void PublisherState::enter(ProducerState next) {
    state = next;
    store_release(pages.control().state, static_cast<std::uint32_t>(next));
    ring();
}

void PublisherState::wait(const WaitTask& task) const {
    wait_for_peer({pages.doorbell().consumer_sequence, pages.control().producer_waiting, pages.control().paused},
                  waiting, task);
}

void PublisherState::end(ProducerState last) noexcept {
    if (ended) return;
    ended = true;
    enter(last);
    unlink_segment(file, name);
    // The mapping stays until the object goes: a subscriber of the same process may share it.
    unlock_byte(file.fd(), producer_lock_byte);
}

std::string PublisherState::label(std::uint32_t i) const {
    const ConsumerEntry& entry = pages.consumer(i);
    return "Consumer '" + printable(entry.name, name_bytes) + "' (process " + std::to_string(entry.pid) + ")";
}

std::string PublisherState::everybody_behind(std::uint64_t frame) const {
    std::string text;
    const std::int64_t now = monotonic_ns();
    for (std::uint32_t i = 0; i < map.consumer_count; ++i) {
        const ConsumerEntry& entry = pages.consumer(i);
        if (!counts(i)) continue;
        const std::uint64_t acknowledged = std::max(load_acquire(entry.acknowledged_frame), members[i].admitted - 1);
        if (acknowledged >= frame) continue;
        const auto silent_ms = (now - static_cast<std::int64_t>(load_relaxed(entry.heartbeat_ns))) / 1'000'000;
        text += (text.empty() ? "" : ", ") + std::string("consumer '") + printable(entry.name, name_bytes) +
                "' (process " + std::to_string(entry.pid) + ", alive, last sign of life " + std::to_string(silent_ms) +
                " ms ago) to release frame " + std::to_string(acknowledged + 1);
    }
    return text.empty() ? "the consumers to release frame " + std::to_string(frame) : text;
}

}  // namespace wade::shm
