#pragma once
// A sign of life that the kernel itself withdraws: an exclusive lock on one byte of the segment, bound to the open file
// description (OFD), which goes when the process ends, however it ends. A forked child keeps its parent's lock alive
// until it executes another program or ends; a recycled process id cannot fool it.

#include <cstdint>

namespace wade::shm {

// Takes the lock; false if another open file has it. Errors: std::system_error.
bool lock_byte(int fd, std::uint64_t byte);

// Gives the lock up.
void unlock_byte(int fd, std::uint64_t byte) noexcept;

// Whether another open file holds the lock. Errors: std::system_error.
bool is_locked_by_other(int fd, std::uint64_t byte);

// Start of this process in clock ticks since boot, as in /proc/self/stat; 0 if unknown.
std::uint64_t process_start_time();

}  // namespace wade::shm
