#pragma once
// Random bits without a state, after SplitMix64 (Steele, Lea, Flood 2014): number n of a stream is
//
//   mix_bits(key + n splitmix_step)
//
// so that a draw does not depend on the draws before it.

#include <cstdint>

namespace wade {

// 2^64 over the golden ratio, odd: multiples of it are spread evenly.
inline constexpr std::uint64_t splitmix_step = 0x9e3779b97f4a7c15ULL;

// The finaliser of SplitMix64 (variant 13 of Stafford): a bijection with full avalanche.
[[nodiscard]] constexpr std::uint64_t mix_bits(std::uint64_t v) {
    v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9ULL;
    v = (v ^ (v >> 27)) * 0x94d049bb133111ebULL;
    return v ^ (v >> 31);
}

// Uniform in [0, 1), a multiple of 2^-53, from mixed bits.
[[nodiscard]] constexpr double unit_fraction(std::uint64_t bits) {
    return static_cast<double>(bits >> 11) * 0x1p-53;
}

}  // namespace wade
