#include "shm_protocol/latest_reader.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include "shm_protocol/inside/atomic.hpp"
#include "shm_protocol/inside/attach.hpp"
#include "shm_protocol/inside/frame_check.hpp"
#include "shm_protocol/inside/publisher_state.hpp"
#include "shm_protocol/publisher.hpp"

namespace wade::shm {

namespace {

// Copies `bytes`, a multiple of 4, from memory aligned to 8, word by word with relaxed atomic loads. The copy may mix old
// and new words; the caller finds out by the sequence around it. The writer's plain stores race with these loads on
// purpose, so ThreadSanitizer is told to look away here and nowhere else.
__attribute__((no_sanitize("thread"), noinline)) void copy_overtaken(void* to, const void* from, std::size_t bytes) {
    using Word [[gnu::may_alias]] = std::uint64_t;
    using HalfWord [[gnu::may_alias]] = std::uint32_t;
    const auto* source = static_cast<const std::byte*>(from);
    auto* target = static_cast<std::byte*>(to);
    std::size_t at = 0;
    for (; at + sizeof(Word) <= bytes; at += sizeof(Word)) {
        const std::uint64_t word = __atomic_load_n(reinterpret_cast<const Word*>(source + at), __ATOMIC_RELAXED);
        std::memcpy(target + at, &word, sizeof word);
    }
    if (at < bytes) {
        const std::uint32_t word = __atomic_load_n(reinterpret_cast<const HalfWord*>(source + at), __ATOMIC_RELAXED);
        std::memcpy(target + at, &word, sizeof word);
    }
}

}  // namespace

struct LatestReader::State {
    State(Link joined, const JoinOptions& options, std::uint32_t wanted_stride)
        : link(std::move(joined)), waiting(options.waiting), stride(wanted_stride) {
        history.check_values = options.check_values;
        history.check_descriptor = link.map->descriptors_have_checks;
        history.check_further = link.map->has_further_hash;
    }

    enum class Outlook { open, complete, ended };

    // Copies the newest frame if it is due, or tells whether one may still come. Errors: peer_aborted.
    Outlook look();

    // Copies the newest frame if it is due and whole; false if there is none now. Errors: protocol_violation.
    bool take_newest();
    bool take(std::uint64_t frame);

    Frame deliver();
    void give_up(const Error& error) noexcept;

    Link link;
    Waiting waiting;
    std::uint32_t stride;
    std::uint64_t last = 0;  // frame taken, 0 = none
    std::uint64_t dropped = 0;
    std::uint64_t overtaken = 0;  // copies that the producer spoiled
    bool over = false;
    std::optional<Error> failure;  // final: it comes again with every further call for a frame
    SlotDescriptor descriptor{};   // of the copy
    std::uint64_t copied = 0;      // frame of the copy
    std::array<std::vector<float>, max_fields> values;
    FrameHistory history;
};

bool LatestReader::State::take(std::uint64_t frame) {
    const SlotDescriptor& shared = link.pages.descriptor(frame);
    if (load_acquire(shared.sequence) != 2 * frame) return false;
    const auto unchanged = [&] {
        fence_acquire();
        return load_ordered(shared.sequence) == 2 * frame;
    };
    copy_overtaken(&descriptor, &shared, sizeof descriptor);
    if (!unchanged()) return false;
    if (descriptor.frame != frame)
        throw Error(Failure::protocol_violation, link.producer() + " published frame " + std::to_string(frame) +
                                                     " with a descriptor of frame " + std::to_string(descriptor.frame) +
                                                     ".");
    check_descriptor(link.map->info, frame, descriptor, history);
    for (std::size_t i = 0; i < link.map->fields.size(); ++i) {
        values[i].resize(descriptor.count);
        copy_overtaken(values[i].data(), link.pages.field(frame, i), descriptor.count * sizeof(float));
    }
    return unchanged();
}

bool LatestReader::State::take_newest() {
    // A producer that overtakes this many copies in a row is too fast to be worth the processor time; the caller looks
    // again later.
    constexpr int tries = 8;
    for (int i = 0; i < tries; ++i) {
        const std::uint64_t newest = load_acquire(link.pages.control().published_frame);
        if (newest == 0 || (last != 0 && (newest < last || newest - last < stride))) return false;
        if (take(newest)) {
            copied = newest;
            return true;
        }
        ++overtaken;
    }
    return false;
}

LatestReader::State::Outlook LatestReader::State::look() {
    // The state is read first: whatever was published before the producer ended is then visible below.
    const std::uint32_t state = load_acquire(link.pages.control().state);
    if (take_newest()) return Outlook::complete;
    if (state == producer_aborted) throw link.producer_gave_up();
    return state == producer_draining || state == producer_closed ? Outlook::ended : Outlook::open;
}

Frame LatestReader::State::deliver() {
    std::array<std::span<const float>, max_fields> fields;
    const std::size_t n = link.map->fields.size();
    for (std::size_t i = 0; i < n; ++i) fields[i] = values[i];
    history.chain = descriptor.previous_hash;  // of the frames before this one, seen or not
    const Frame frame = checked_frame(link.map->info, copied, descriptor, std::span(fields).first(n), history);
    if (last != 0) dropped += copied - last - stride;
    last = copied;
    store_relaxed(link.entry->dropped_frames, dropped);
    store_release(link.entry->acknowledged_frame, last);
    return frame;
}

void LatestReader::State::give_up(const Error& error) noexcept {
    failure = error;
    over = true;
    link.say_goodbye(consumer_aborted, error.exit_code(), error.what());
}

LatestReader::LatestReader(const std::string& session, const std::string& consumer_name, JoinOptions options,
                           std::uint32_t stride) {
    if (stride == 0) throw std::invalid_argument("LatestReader: a stride of 0 is not allowed, 1 is every frame.");
    state_ = std::make_unique<State>(attach({session, consumer_name, options, mode_latest, stride, nullptr}), options,
                                     stride);
}

LatestReader LatestReader::in_process(Publisher& publisher, const std::string& consumer_name, JoinOptions options,
                                      std::uint32_t stride) {
    if (stride == 0) throw std::invalid_argument("LatestReader: a stride of 0 is not allowed, 1 is every frame.");
    const PublisherState& p = *publisher.state_;
    options.kind = p.map.info.kind;
    auto* const base = static_cast<std::byte*>(p.region.get_address());
    return LatestReader(std::make_unique<State>(attach({p.session, consumer_name, options, mode_latest, stride, base}),
                                                options, stride));
}

LatestReader::LatestReader(std::unique_ptr<State> state) : state_(std::move(state)) {}

LatestReader::~LatestReader() {
    if (state_) leave();
}

LatestReader::LatestReader(LatestReader&&) noexcept = default;

LatestReader& LatestReader::operator=(LatestReader&& other) noexcept {
    if (this != &other) {
        if (state_) leave();
        state_ = std::move(other.state_);
    }
    return *this;
}

const StreamInfo& LatestReader::info() const {
    return state_->link.map->info;
}
bool LatestReader::ended() const {
    return state_->over;
}
std::uint64_t LatestReader::dropped_frames() const {
    return state_->dropped;
}

std::optional<Frame> LatestReader::next() {
    State& s = *state_;
    if (s.failure) throw Error(*s.failure);
    if (s.over) return std::nullopt;
    try {
        s.link.heartbeat();
        State::Outlook outlook = State::Outlook::open;
        WaitTask task;
        task.ready = [&] {
            outlook = s.look();
            return outlook != State::Outlook::open;
        };
        task.after_slice = [&] {
            s.link.heartbeat();
            if (s.link.producer_lives()) return;
            outlook = s.look();
            if (outlook == State::Outlook::open) throw s.link.producer_died();
        };
        const std::uint64_t overtaken_before = s.overtaken;
        task.what = [&] {
            const std::uint64_t n = s.overtaken - overtaken_before;
            return s.link.next_frame() + (n == 0 ? "" : "; " + std::to_string(n) + " copies were overtaken");
        };
        task.paused = [&] { return load_acquire(s.link.pages.control().paused) != 0; };
        task.timeout_s = s.waiting.step_timeout_s;
        task.warning_s = s.waiting.step_warning_s;
        wait_for_peer(s.link.bed(), s.waiting, task);
        s.over = outlook == State::Outlook::ended;
        if (s.over) return std::nullopt;
        return s.deliver();
    } catch (const Error& error) {
        s.give_up(error);
        throw;
    }
}

std::optional<Frame> LatestReader::poll() {
    State& s = *state_;
    if (s.failure) throw Error(*s.failure);
    if (s.over) return std::nullopt;
    try {
        s.link.heartbeat();
        // The lock is probed first: what its holder published before it died is seen by the look that follows.
        const bool lives = s.link.producer_lives();
        const State::Outlook outlook = s.look();
        if (outlook == State::Outlook::complete) return s.deliver();
        s.over = outlook == State::Outlook::ended;
        if (!s.over && !lives) throw s.link.producer_died();
        return std::nullopt;
    } catch (const Error& error) {
        s.give_up(error);
        throw;
    }
}

bool LatestReader::producer_is_there() const {
    return state_->link.producer_lives();
}

void LatestReader::leave() noexcept {
    state_->over = true;
    state_->link.say_goodbye(consumer_left, 0, "");
}

}  // namespace wade::shm
