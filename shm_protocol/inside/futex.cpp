#include "shm_protocol/inside/futex.hpp"

#include <linux/futex.h>
#include <sched.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <climits>

namespace wade::shm {

// Without FUTEX_PRIVATE_FLAG: the sleeper and the waker are different processes.
Wake futex_wait(const std::uint32_t& word, std::uint32_t seen, std::int64_t at_most_ns) {
    timespec slice{};
    slice.tv_sec = at_most_ns / 1'000'000'000;
    slice.tv_nsec = at_most_ns % 1'000'000'000;
    if (syscall(SYS_futex, &word, FUTEX_WAIT, seen, &slice, nullptr, 0) == 0 || errno == EAGAIN) return Wake::changed;
    return errno == EINTR ? Wake::signal : Wake::timed_out;
}

void futex_wake_all(const std::uint32_t& word) {
    syscall(SYS_futex, &word, FUTEX_WAKE, INT_MAX, nullptr, nullptr, 0);
}

std::int64_t monotonic_ns() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<std::int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
}

int usable_cpus() {
    cpu_set_t set;
    CPU_ZERO(&set);
    return sched_getaffinity(0, sizeof(set), &set) == 0 ? CPU_COUNT(&set) : 2;
}

}  // namespace wade::shm
