#include "shm_protocol/inside/wait.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "shm_protocol/inside/atomic.hpp"
#include "shm_protocol/inside/futex.hpp"

namespace wade::shm {
namespace {

std::string seconds(double s) {
    char text[32];
    std::snprintf(text, sizeof text, "%g s", s);
    return text;
}

void relax_cpu() {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    asm volatile("yield");
#endif
}

bool spin(const std::function<bool()>& ready) {
    if (ready()) return true;
    static const bool alone = usable_cpus() == 1;
    if (alone) return false;
    const std::int64_t end = monotonic_ns() + spin_ns;
    do {
        for (int i = 0; i < 16; ++i) {
            if (ready()) return true;
            relax_cpu();
        }
    } while (monotonic_ns() < end);
    return false;
}

struct WaitingFlag {
    explicit WaitingFlag(std::uint32_t& flag) : flag_(flag) { store_ordered(flag_, 1U); }
    ~WaitingFlag() { store_relaxed(flag_, 0U); }
    WaitingFlag(const WaitingFlag&) = delete;
    WaitingFlag& operator=(const WaitingFlag&) = delete;
    std::uint32_t& flag_;
};

// A process that waits for a paused peer counts as paused, as long as it waits.
class PassedOnPause {
 public:
    explicit PassedOnPause(std::uint32_t& word) : word_(word), before_(load_relaxed(word)) {}
    ~PassedOnPause() { set(false); }
    PassedOnPause(const PassedOnPause&) = delete;
    PassedOnPause& operator=(const PassedOnPause&) = delete;
    void set(bool paused) {
        if (passed_on_ != paused) store_release(word_, paused ? 1U : before_);
        passed_on_ = paused;
    }

 private:
    std::uint32_t& word_;
    std::uint32_t before_;  // this side may pause itself
    bool passed_on_ = false;
};

// Returns true if what a task waits for has come; false, too, where it can no longer be read, as after this side's goodbye.
bool has_come(const WaitTask& task) {
    try {
        return task.ready();
    } catch (const Error&) {
        return false;
    }
}

}  // namespace

void Patience::count(double s) {
    constexpr double longest = 4 * 1e-9 * static_cast<double>(slice_ns);  // a busy machine may be late by some slices
    spent_s_ += s > longest ? 1e-9 * static_cast<double>(slice_ns) : std::max(s, 0.0);
}

void check_waiting(const Waiting& waiting) {
    const auto demand = [](const char* name, double value) {
        if (!(value >= 0))
            throw std::invalid_argument(std::string(name) + " = " + std::to_string(value) +
                                        " is out of range: 0 (never) or more, in seconds.");
    };
    demand("attach_timeout_s", waiting.attach_timeout_s);
    demand("step_timeout_s", waiting.step_timeout_s);
    demand("step_warning_s", waiting.step_warning_s);
}

void check_interrupted(const Waiting& waiting, const std::string& what) {
    if (waiting.interrupted && waiting.interrupted())
        throw Error(Failure::interrupted, "Interrupted while waiting for " + what + ".");
}

void wait_for_peer(const Sleep& sleep, const Waiting& waiting, const WaitTask& task) {
    if (spin(task.ready)) return;
    const WaitingFlag flag(sleep.waiting);
    PassedOnPause pause(sleep.paused);
    Patience patience(task.timeout_s);
    bool warned = task.warning_s <= 0 || !waiting.warn;
    std::int64_t last = monotonic_ns();
    for (;;) {
        const std::uint32_t seen = load_ordered(sleep.sequence);
        if (task.ready()) return;
        const Wake wake = futex_wait(sleep.sequence, seen, slice_ns);
        const std::int64_t now = monotonic_ns();
        if (wake == Wake::changed && now - last < slice_ns) continue;
        const double waited = 1e-9 * static_cast<double>(now - last);
        last = now;
        const bool paused = task.paused && task.paused();
        pause.set(paused);
        if (!paused) patience.count(waited);
        if (paused && waiting.paused) waiting.paused(waited);
        try {
            check_interrupted(waiting, task.what());
        } catch (const Error&) {
            if (has_come(task)) return;  // before what interrupts, as an ordered end of the peer
            throw;
        }
        task.after_slice();
        if (!warned && patience.spent_s() >= task.warning_s) {
            warned = true;
            waiting.warn("Waiting for " + task.what() + " since " + seconds(task.warning_s) + ".");
        }
        if (patience.exhausted() && !task.ready())
            throw Error(task.on_timeout, "Waited " + seconds(task.timeout_s) + " in vain for " + task.what() + ".");
    }
}

}  // namespace wade::shm
