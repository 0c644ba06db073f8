#pragma once
// Random numbers without a state: a hash of (seed, stream, counter), so that a draw does not depend on earlier draws.

#include <cstdint>

#include "configs/numbers/splitmix.hpp"

namespace wade::crowd {

// Returns the key of a stream of numbers.
[[nodiscard]] constexpr std::uint64_t counter_key(std::uint64_t seed, std::uint64_t stream) {
    return mix_bits(mix_bits(seed + splitmix_step) + stream * splitmix_step);
}

// Returns a uniform number in [0, 1), a multiple of 2^-53.
[[nodiscard]] constexpr double counter_uniform(std::uint64_t key, std::uint64_t counter) {
    return unit_fraction(mix_bits(key + counter * splitmix_step));
}
[[nodiscard]] constexpr double counter_uniform(std::uint64_t seed, std::uint64_t stream, std::uint64_t counter) {
    return counter_uniform(counter_key(seed, stream), counter);
}

}  // namespace wade::crowd
