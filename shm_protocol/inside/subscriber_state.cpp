#include "shm_protocol/inside/subscriber_state.hpp"

#include <array>
#include <utility>

#include "shm_protocol/inside/atomic.hpp"

namespace wade::shm {

SubscriberState::SubscriberState(Link joined, const JoinOptions& options)
    : link(std::move(joined)), waiting(options.waiting) {
    history.check_values = options.check_values;
    history.check_descriptor = link.map->descriptors_have_checks;
    history.check_further = link.map->has_further_hash;
}

SubscriberState::Outlook SubscriberState::look() {
    const Control& control = link.pages.control();
    link.check_entry(released);
    // The state is read first: whatever was published before the producer ended is then visible below.
    const std::uint32_t state = load_acquire(control.state);
    if (next == 0) next = load_acquire(control.admitted_frame[link.index]);
    const std::uint64_t published = load_acquire(control.published_frame);
    if (next != 0 && published >= next) {
        if (published - next >= link.map->info.depth)
            throw Error(Failure::protocol_violation, link.producer() + " published frame " + std::to_string(published) +
                                                         " before frame " + std::to_string(next) + " was released.");
        return Outlook::complete;
    }
    if (state == producer_aborted) throw link.producer_gave_up();
    if (state != producer_draining && state != producer_closed) return Outlook::open;
    if (next == 0) throw link.ended_before_entry();
    return Outlook::ended;
}

bool SubscriberState::wait_for_next() {
    link.heartbeat();
    Outlook outlook = Outlook::open;
    WaitTask task;
    task.ready = [&] {
        outlook = look();
        return outlook != Outlook::open;
    };
    task.after_slice = [&] {
        link.heartbeat();
        if (!link.producer_lives() && look() == Outlook::open) throw link.producer_died();
    };
    task.what = [&] { return link.next_frame(); };
    task.paused = [&] { return load_acquire(link.pages.control().paused) != 0; };
    task.timeout_s = waiting.step_timeout_s;
    task.warning_s = waiting.step_warning_s;
    wait_for_peer(link.bed(), waiting, task);
    return outlook == Outlook::complete;
}

Frame SubscriberState::check_frame() {
    const StreamInfo& info = link.map->info;
    const SlotDescriptor& shared = link.pages.descriptor(next);
    const std::uint64_t sequence = load_acquire(shared.sequence);
    const SlotDescriptor d = shared;
    if (sequence != 2 * next || d.frame != next)
        throw Error(Failure::protocol_violation, "Frame " + std::to_string(next) + " from '" + info.producer_name +
                                                     "' is not complete: its slot holds frame " +
                                                     std::to_string(d.frame) + " with sequence " +
                                                     std::to_string(sequence) + ".");
    check_descriptor(info, next, d, history);
    std::array<std::span<const float>, max_fields> fields;
    const std::size_t n = link.map->fields.size();
    for (std::size_t i = 0; i < n; ++i) fields[i] = {link.pages.field(next, i), d.count};
    if (!history.last && next > 1) history.chain = d.previous_hash;  // of the frames before this consumer joined
    return checked_frame(info, next, d, std::span(fields).first(n), history);
}

void SubscriberState::say_goodbye(ConsumerState last, int reason_code, std::string_view text) noexcept {
    over = true;
    held = 0;
    link.say_goodbye(last, reason_code, text);
}

void SubscriberState::finish() noexcept {
    if (over && held == 0)
        say_goodbye(consumer_left, 0, "");
    else
        say_goodbye(consumer_aborted, static_cast<int>(Failure::peer_aborted), "It ended before the last frame.");
}

}  // namespace wade::shm
