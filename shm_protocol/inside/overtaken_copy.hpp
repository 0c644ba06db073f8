#pragma once
// Copying bytes that their writer may change meanwhile.

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace wade::shm {

// Copies `bytes`, a multiple of 4, from memory aligned to 8, word by word with relaxed atomic loads. The copy may mix old
// and new words; the caller finds out by the sequence around it. The writer's plain stores race with these loads on
// purpose, so ThreadSanitizer is told to look away here and nowhere else.
__attribute__((no_sanitize("thread"), noinline)) inline void copy_overtaken(void* to, const void* from,
                                                                            std::size_t bytes) {
    using Word [[gnu::may_alias]] = std::uint64_t;
    using HalfWord [[gnu::may_alias]] = std::uint32_t;
    const auto* source = static_cast<const std::byte*>(from);
    auto* target = static_cast<std::byte*>(to);
    std::size_t at = 0;
    for (; at + sizeof(Word) <= bytes; at += sizeof(Word)) {
        const std::uint64_t word = __atomic_load_n(reinterpret_cast<const Word*>(source + at), __ATOMIC_RELAXED);
        std::memcpy(target + at, &word, sizeof word);
    }
    if (at < bytes) {
        const std::uint32_t word = __atomic_load_n(reinterpret_cast<const HalfWord*>(source + at), __ATOMIC_RELAXED);
        std::memcpy(target + at, &word, sizeof word);
    }
}

}  // namespace wade::shm
