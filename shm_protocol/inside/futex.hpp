#pragma once
// Sleeping on a word that another process changes.

#include <cstdint>
#include <ctime>

namespace wade::shm {

enum class Wake { changed, timed_out, signal };

// Sleeps while `word` holds `seen`, at most at_most_ns; the word may be mapped read-only. Spurious returns are possible.
Wake futex_wait(const std::uint32_t& word, std::uint32_t seen, std::int64_t at_most_ns);

// Wakes all sleepers on `word` in all processes.
void futex_wake_all(const std::uint32_t& word);

// CLOCK_MONOTONIC, the same for all processes of a machine.
std::int64_t monotonic_ns();

// CPUs that this process may run on; with a single one spinning only keeps the peer from working.
int usable_cpus();

}  // namespace wade::shm
