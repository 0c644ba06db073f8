#pragma once
// One wait for the peer: spin briefly, then sleep in slices, and look after each slice whether it still makes sense.

#include <cstdint>
#include <functional>
#include <string>

#include "shm_protocol/stream.hpp"

namespace wade::shm {

// The words that a waiter and its waker share. The waker stores its news, adds one to `sequence` and then looks at
// `waiting`; the waiter sets `waiting`, reads `sequence` and then looks for the news. All four are sequentially
// consistent, so at least one of the two sees the other: no wake-up is lost.
struct Sleep {
    const std::uint32_t& sequence;  // futex word, counted up by the peer
    std::uint32_t& waiting;         // 1 while this side sleeps or is about to
    std::uint32_t& paused;          // 1 while this side pauses, or waits for one that does: a pause is passed on
};

struct WaitTask {
    std::function<bool()> ready;        // true = the wait is over; may throw
    std::function<void()> after_slice;  // liveness, heartbeat; may throw
    std::function<std::string()> what;  // "frame 120 of producer 'dfsph'", for the messages
    std::function<bool()> paused = {};  // the peer pauses on purpose: the time does not count; empty = never
    Failure on_timeout = Failure::step_timeout;
    double timeout_s = 0;  // 0 = never
    double warning_s = 0;  // 0 = never
};

// Errors: task.on_timeout, Failure::interrupted, and whatever `ready` and `after_slice` throw.
void wait_for_peer(const Sleep& sleep, const Waiting& waiting, const WaitTask& task);

// Waiting time while this process ran. A slice that took much longer than planned counts as one slice, because the
// process was probably stopped meanwhile.
class Patience {
 public:
    explicit Patience(double limit_s) : limit_s_(limit_s) {}
    void count(double seconds);
    [[nodiscard]] double spent_s() const { return spent_s_; }
    [[nodiscard]] bool exhausted() const { return limit_s_ > 0 && spent_s_ >= limit_s_; }

 private:
    double limit_s_;
    double spent_s_ = 0;
};

inline constexpr std::int64_t slice_ns = 50'000'000;  // also the delay after which a dead peer is noticed
inline constexpr std::int64_t spin_ns = 30'000;       // about the cost of two futex round trips

// Errors: std::invalid_argument for a time-out that is negative or no number.
void check_waiting(const Waiting& waiting);

// Throws Failure::interrupted if the caller asked to stop.
void check_interrupted(const Waiting& waiting, const std::string& what);

}  // namespace wade::shm
