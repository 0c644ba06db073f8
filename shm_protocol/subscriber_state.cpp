#include "shm_protocol/subscriber_state.hpp"

#include <utility>

#include "shm_protocol/atomic.hpp"
#include "shm_protocol/futex.hpp"
#include "shm_protocol/hash.hpp"
#include "shm_protocol/liveness.hpp"
#include "shm_protocol/wait.hpp"

namespace wade::shm {

Subscriber::State::State(Link joined, const std::string& session_name, Waiting how)
    : link(std::move(joined)), session(session_name), waiting(std::move(how)) {}

std::string Subscriber::State::producer() const {
    return "Producer '" + link.map->info.producer_name + "' (process " + std::to_string(link.producer_pid) + ")";
}

void Subscriber::State::heartbeat() noexcept {
    if (gone) return;  // the entry may have another owner by now
    store_relaxed(link.entry->heartbeat_ns, static_cast<std::uint64_t>(monotonic_ns()));
}

Subscriber::State::Outlook Subscriber::State::look() {
    const Control& control = link.pages.control();
    // The state is read first: whatever was published before the producer ended is then visible below.
    const std::uint32_t state = load_acquire(control.state);
    if (next == 0) {
        next = load_acquire(control.admitted_frame[link.index]);
        last_tick = 0;
    }
    const std::uint64_t published = load_acquire(control.published_frame);
    if (next != 0 && published >= next) {
        if (published - next >= link.map->info.depth)
            throw Error(Failure::protocol_violation, producer() + " published frame " + std::to_string(published) +
                                                         " before frame " + std::to_string(next) + " was released.");
        return Outlook::complete;
    }
    if (state == producer_aborted)
        throw Error(Failure::peer_aborted, producer() + " gave up at frame " + std::to_string(published + 1) + ": " +
                                               printable(control.reason_text, reason_bytes));
    if (state != producer_draining && state != producer_closed) return Outlook::open;
    if (next == 0)
        throw Error(Failure::attach_timeout, producer() + " ended its stream before consumer '" +
                                                 printable(link.entry->name, name_bytes) + "' could take part.");
    return Outlook::ended;
}

bool Subscriber::State::wait_for_next() {
    heartbeat();
    Outlook outlook = Outlook::open;
    WaitTask task;
    task.ready = [&] {
        outlook = look();
        return outlook != Outlook::open;
    };
    task.after_slice = [&] {
        heartbeat();
        if (is_locked_by_other(link.file.fd(), producer_lock_byte) || look() != Outlook::open) return;
        const std::uint64_t published = load_acquire(link.pages.control().published_frame);
        throw Error(Failure::peer_dead, producer() + " died at frame " + std::to_string(published + 1) +
                                            "; the last complete frame is " + std::to_string(published) + ".");
    };
    task.what = [&] {
        const Control& control = link.pages.control();
        const auto silent_ms =
            (monotonic_ns() - static_cast<std::int64_t>(load_relaxed(control.heartbeat_ns))) / 1'000'000;
        return "frame " + std::to_string(load_acquire(control.published_frame) + 1) + " of producer '" +
               link.map->info.producer_name + "' (process " + std::to_string(link.producer_pid) +
               ", alive, last sign of life " + std::to_string(silent_ms) + " ms ago)";
    };
    task.timeout_s = waiting.step_timeout_s;
    task.warning_s = waiting.step_warning_s;
    wait_for_peer({link.pages.control().publish_sequence, link.entry->waiting}, waiting, task);
    return outlook == Outlook::complete;
}

Frame Subscriber::State::check_frame() {
    const SlotDescriptor& shared = link.pages.descriptor(next);
    const std::uint64_t sequence = load_acquire(shared.sequence);
    const SlotDescriptor d = shared;
    const auto refuse = [&](const std::string& why) {
        throw Error(Failure::protocol_violation,
                    "Frame " + std::to_string(next) + " from '" + link.map->info.producer_name + "' " + why + ".");
    };
    if (sequence != 2 * next || d.frame != next)
        refuse("is not complete: its slot holds frame " + std::to_string(d.frame) + " with sequence " +
               std::to_string(sequence));
    if (d.count > link.map->info.capacity)
        refuse("holds " + std::to_string(d.count) + " particles, the capacity is " +
               std::to_string(link.map->info.capacity));
    if (d.tick <= last_tick)
        refuse("has tick " + std::to_string(d.tick) + ", the frame before it has " + std::to_string(last_tick));

    HashedFields fields;
    for (std::size_t i = 0; i < fields.size(); ++i) fields[i] = {link.pages.field(next, i), d.count};
    if (first && next > 1) chain = d.previous_hash;  // of the frames before this consumer joined
    const ChainResult result = chain_frame(chain, next, fields);
    if (d.hash != 0 && d.hash != result.hash)
        refuse("does not match its hash: it was changed after it was published, or its chain is another one");
    if (result.nonfinite) {
        for (std::size_t i = 0; i < fields.size(); ++i)
            if (const std::size_t k = first_nonfinite(fields[i]); k < fields[i].size())
                refuse("holds non-finite values (first: particle " + std::to_string(k) + ", field " + field_names[i] +
                       ")");
    }
    if ((d.flags & frame_nonfinite) != 0) refuse("is marked by its producer as holding non-finite values");
    first = false;
    chain = result.hash;
    last_tick = d.tick;
    return Frame{next,         d.tick,    d.count,   (d.flags & frame_final) != 0,
                 chain,        fields[0], fields[1], fields[2],
                 fields[3],    fields[4], fields[5], fields[6],
                 d.diagnostics};
}

void Subscriber::State::say_goodbye(ConsumerState last, int reason_code, std::string_view text) noexcept {
    if (gone) return;
    gone = true;
    over = true;
    held = 0;
    link.entry->reason_code = reason_code;
    store_text(link.entry->reason_text, reason_bytes, text);
    store_release(link.entry->state, static_cast<std::uint32_t>(last));
    link.ring();
    unlock_byte(link.file.fd(), consumer_lock_byte + link.index);
}

void Subscriber::State::finish() noexcept {
    if (over && held == 0)
        say_goodbye(consumer_left, 0, "");
    else
        say_goodbye(consumer_aborted, static_cast<int>(Failure::peer_aborted), "It ended before the last frame.");
}

}  // namespace wade::shm
