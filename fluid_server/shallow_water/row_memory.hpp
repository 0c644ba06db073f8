#pragma once
// Memory for rows of the grid: each row begins at a cache line, as a vector that lies across two costs twice.

#include <cstddef>
#include <new>
#include <vector>

namespace wade::fluid::shallow_water {

inline constexpr std::size_t line_bytes = 64;
inline constexpr std::size_t line_values = line_bytes / sizeof(double);

template <typename T>
struct LineAllocator {
    using value_type = T;
    LineAllocator() = default;
    template <typename U>
    LineAllocator(const LineAllocator<U>&) {}  // NOLINT(google-explicit-constructor): as the standard asks for
    T* allocate(std::size_t n) { return static_cast<T*>(::operator new (n * sizeof(T), std::align_val_t{line_bytes})); }
    void deallocate(T* p, std::size_t) { ::operator delete (p, std::align_val_t{line_bytes}); }
    friend bool operator==(const LineAllocator&, const LineAllocator&) { return true; }
};

using RowMemory = std::vector<double, LineAllocator<double>>;

// The next multiple of a cache line, in values.
constexpr std::size_t whole_lines(std::size_t values) {
    return (values + line_values - 1) / line_values * line_values;
}

}  // namespace wade::fluid::shallow_water
