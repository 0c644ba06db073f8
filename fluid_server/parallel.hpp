#pragma once
// Loops over particles, split into blocks of fixed size.
//
// Blocks do not depend on the number of threads, a block is worked by one thread, and sums are combined in the order
// of the blocks: the same bits for any number of threads.

#include <algorithm>
#include <cstddef>
#include <vector>

namespace wade::fluid {

inline constexpr std::size_t block_size = 256;

// With fewer blocks than this the threads would wait for one another longer than they work.
inline constexpr std::ptrdiff_t serial_below = 12;

inline std::size_t block_count(std::size_t n) {
    return (n + block_size - 1) / block_size;
}

// Calls body(begin, end, block) for each block of [0, n), in parallel where there is enough to share.
template <typename Body>
void for_each_block(std::size_t n, Body&& body) {
    const auto blocks = static_cast<std::ptrdiff_t>(block_count(n));
#pragma omp parallel for schedule(static) if (blocks >= serial_below)
    for (std::ptrdiff_t b = 0; b < blocks; ++b) {
        const std::size_t begin = static_cast<std::size_t>(b) * block_size;
        body(begin, std::min(begin + block_size, n), static_cast<std::size_t>(b));
    }
}

// Calls body(i) for each i in [0, n).
template <typename Body>
void for_each_particle(std::size_t n, Body&& body) {
    for_each_block(n, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            body(i);
        }
    });
}

// Sums of a sweep, one entry a block; kept by the caller so that the step allocates nothing.
template <typename T>
class BlockSums {
 public:
    void begin(std::size_t n) { sums_.assign(block_count(n), T{}); }
    T& operator[](std::size_t block) { return sums_[block]; }

    // Combines the entries in the order of the blocks with combine(total, entry).
    template <typename Combine>
    [[nodiscard]] T total(Combine&& combine) const {
        T result{};
        for (const T& entry : sums_) {
            combine(result, entry);
        }
        return result;
    }

 private:
    std::vector<T> sums_;
};

}  // namespace wade::fluid
