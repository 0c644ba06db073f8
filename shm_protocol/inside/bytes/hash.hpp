#pragma once
// The running hash of all frames so far: proof that two runs, or two sides of one run, saw the same bits.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace wade::shm {

// The arrays of a fluid frame in the order mass, vx, vy, vz, px, py, pz.
using HashedFields = std::array<std::span<const float>, 7>;

// The required arrays of a frame of any kind in their order (header.hpp: required_fields), at least one, all of one
// length.
using FieldSpans = std::span<const std::span<const float>>;

struct ChainResult {
    std::uint64_t hash;
    bool nonfinite;  // some value is a NaN or an infinity
    bool massless;   // some value of the first field, the mass, is not above 0
};

// The chain of frame f from the chain of frame f - 1 (0 before the first frame), in one pass over the arrays.
//
// With w_k the bits of value k (from 0) of a field as an unsigned 32-bit number, all products of two 32-bit numbers
// exact in 64 bits and all sums modulo 2^64:
//
//   x_k = w_k + 0x9E3779B1 (k + 1) mod 2^32          y_k = rotate_left(w_k, 16) xor (0x85EBCA77 (k + 1) mod 2^32)
//   S   = sum over k of x_k y_k                      one sum for each field
//   mix(z): z ^= z >> 30; z *= 0xBF58476D1CE4E5B9; z ^= z >> 27; z *= 0x94D049BB133111EB; z ^= z >> 31
//   h = mix(previous + 0x9E3779B97F4A7C15); h = mix(h ^ frame); h = mix(h ^ count); h = mix(h ^ S) for each field
//   the chain is h, or 1 if h = 0 (0 means "not given")
//
// The sums do not depend on the order of the terms, so any language computes them with whole-array operations and any
// number of threads gives the same value. Not meant against an attacker.
ChainResult chain_frame(std::uint64_t previous, std::uint64_t frame, FieldSpans fields);

// The same, the hash alone.
std::uint64_t chain_hash(std::uint64_t previous, std::uint64_t frame, FieldSpans fields);

// Position of the first NaN or infinity in an array, its length if there is none.
std::size_t first_nonfinite(std::span<const float> values);

// Position of the first value that is not above 0 (its sign bit is set, or it is 0), as above.
std::size_t first_massless(std::span<const float> mass);

}  // namespace wade::shm
