#pragma once
// Memory that a process may still take, asked for before it is taken: what runs out in the middle of a run ends other
// programs as well.

#include <string>

namespace wade {

// The least of what the machine has left, what the control group of this process may still take, and its limit of address
// space, bytes; infinite where nothing is known.
[[nodiscard]] double available_memory();

// "40 MB", "2.3 GB"
[[nodiscard]] std::string memory_text(double bytes);

// Throws ConfigurationError if `needed` is more than `available`, both in bytes. source: begins the message;
// advice: what to change in the scene.
void check_memory(double needed, double available, const std::string& source, const std::string& advice);

}  // namespace wade
