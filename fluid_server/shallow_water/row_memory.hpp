#pragma once
// Memory for rows of the grid: each row begins at a cache line, as a vector that lies across two costs twice. A large field lies
// in huge pages where the system has them, as else each row of each field has a page of its own, more than a processor keeps in
// mind; and not all fields begin at the same place of their page, as then they would have the same few places in the cache.

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <new>
#include <vector>

namespace wade::fluid::shallow_water {

inline constexpr std::size_t line_bytes = 64;
inline constexpr std::size_t line_values = line_bytes / sizeof(double);
inline constexpr std::size_t huge_page_bytes = std::size_t{1} << 21;

// The bytes that a field of so many takes.
constexpr std::size_t bytes_in_memory(std::size_t bytes) {
    if (bytes < huge_page_bytes / 2) return bytes;
    constexpr std::size_t room = 16 * 65 * line_bytes;  // to begin somewhere else
    return (bytes + room + huge_page_bytes - 1) / huge_page_bytes * huge_page_bytes;
}

template <typename T>
struct LineAllocator {
    using value_type = T;
    LineAllocator() = default;
    template <typename U>
    LineAllocator(const LineAllocator<U>&) {}  // NOLINT(google-explicit-constructor): as the standard asks for
    T* allocate(std::size_t n) {
        const std::size_t bytes = bytes_in_memory(n * sizeof(T));
        void* const memory = ::operator new(bytes, alignment(n));
        if (!has_pages(n)) return static_cast<T*>(memory);
        ::madvise(memory, bytes, MADV_HUGEPAGE);  // a wish
        const std::size_t lines = reinterpret_cast<std::uintptr_t>(memory) / huge_page_bytes % 16 * 65;
        return reinterpret_cast<T*>(static_cast<std::byte*>(memory) + lines * line_bytes);
    }
    void deallocate(T* p, std::size_t n) {
        const std::size_t before = has_pages(n) ? reinterpret_cast<std::uintptr_t>(p) % huge_page_bytes : 0;
        ::operator delete(reinterpret_cast<std::byte*>(p) - before, alignment(n));
    }
    friend bool operator==(const LineAllocator&, const LineAllocator&) { return true; }

 private:
    static bool has_pages(std::size_t n) { return n * sizeof(T) >= huge_page_bytes / 2; }
    static std::align_val_t alignment(std::size_t n) {
        return std::align_val_t{has_pages(n) ? huge_page_bytes : line_bytes};
    }
};

using RowMemory = std::vector<double, LineAllocator<double>>;

// The next multiple of a cache line, in values.
constexpr std::size_t whole_lines(std::size_t values) {
    return (values + line_values - 1) / line_values * line_values;
}

}  // namespace wade::fluid::shallow_water
