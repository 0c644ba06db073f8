#pragma once
// 64-bit FNV-1a (Fowler, Noll, Vo): detects changes of a text or an array, but is no protection against forgery.

#include <cstdint>
#include <string_view>

namespace wade {

inline constexpr std::uint64_t fnv1a_basis = 0xcbf29ce484222325ULL;  // the hash of nothing

// The hash with one more byte. Whole words instead of bytes are as many times faster as they are longer, and any single
// change still shows; the hash is then another one.
[[nodiscard]] constexpr std::uint64_t fnv1a_next(std::uint64_t hash, std::uint64_t value) {
    return (hash ^ value) * 0x100000001b3ULL;
}

// Of the bytes of a text.
[[nodiscard]] constexpr std::uint64_t fnv1a(std::string_view text) {
    std::uint64_t hash = fnv1a_basis;
    for (const char c : text) hash = fnv1a_next(hash, static_cast<unsigned char>(c));
    return hash;
}

}  // namespace wade
