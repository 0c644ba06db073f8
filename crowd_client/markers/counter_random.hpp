#pragma once
// Random numbers without a state: a hash of (seed, stream, counter), so that a draw does not depend on who made the
// draws before it.

#include <cstdint>

namespace wade::crowd {

// The finaliser of SplitMix64 (Steele, Lea, Flood 2014, variant 13 of Stafford): a bijection with full avalanche.
[[nodiscard]] constexpr std::uint64_t mix_bits(std::uint64_t v) {
    v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9ULL;
    v = (v ^ (v >> 27)) * 0x94d049bb133111ebULL;
    return v ^ (v >> 31);
}

// Uniform in [0, 1), a multiple of 2^-53.
[[nodiscard]] constexpr double counter_uniform(std::uint64_t seed, std::uint64_t stream, std::uint64_t counter) {
    constexpr std::uint64_t golden = 0x9e3779b97f4a7c15ULL;
    const std::uint64_t bits = mix_bits(mix_bits(mix_bits(seed + golden) + stream * golden) + counter * golden);
    return static_cast<double>(bits >> 11) * 0x1p-53;
}

}  // namespace wade::crowd
