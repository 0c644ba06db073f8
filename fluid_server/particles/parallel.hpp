#pragma once
// Loops over particles, split into blocks of fixed size.
//
// Blocks do not depend on the number of threads, a block is worked by one thread, whichever it is, and sums are combined
// in the order of the blocks: the same bits for any number of threads.

#include <omp.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <vector>

namespace wade::fluid {

inline constexpr std::size_t block_size = 256;

// With fewer blocks than this the threads would wait for one another longer than they work.
inline constexpr std::size_t serial_below = 12;

// More threads than this do not share a loop.
inline constexpr std::size_t most_shares = 128;

inline std::size_t block_count(std::size_t n) {
    return (n + block_size - 1) / block_size;
}

// How many threads share a loop over n particles.
inline std::size_t shares_of(std::size_t n) {
    if (block_count(n) < serial_below) return 1;
    return std::min(static_cast<std::size_t>(omp_get_max_threads()), most_shares);
}

// Calls body(s) for each s in [0, shares), a thread each.
template <typename Body>
void for_each_share(std::size_t shares, Body&& body) {
    const int n = static_cast<int>(shares);
#pragma omp parallel for num_threads(n) schedule(static, 1) if (n > 1)
    for (int s = 0; s < n; ++s) body(static_cast<std::size_t>(s));
}

// Items [next, end) that one thread is to work, on a cache line of its own.
struct alignas(64) ItemShare {
    std::atomic<std::size_t> next{0};
    std::size_t end = 0;
};

// Calls body(item, thread) for each item of [0, items). Each thread works the items of its own share of the range, side by side
// in memory, and then helps those that are behind: on a shared machine threads are not equally fast.
template <typename Body>
void for_each_item(std::size_t items, std::size_t threads, Body&& body) {
    if (threads == 1) {
        for (std::size_t n = 0; n < items; ++n) body(n, std::size_t{0});
        return;
    }
    std::array<ItemShare, most_shares> shares;
    for (std::size_t s = 0; s < threads; ++s) {
        shares[s].next.store(s * items / threads, std::memory_order_relaxed);
        shares[s].end = (s + 1) * items / threads;
    }
#pragma omp parallel num_threads(static_cast <int>(threads))
    {
        const auto own = static_cast<std::size_t>(omp_get_thread_num());
        for (std::size_t k = 0; k < threads; ++k) {
            ItemShare& share = shares[(own + k) % threads];
            for (;;) {
                const std::size_t n = share.next.fetch_add(1, std::memory_order_relaxed);
                if (n >= share.end) break;
                body(n, own);
            }
        }
    }
}

// Calls body(begin, end, block) for each block of [0, n), in parallel where there is enough to share.
template <typename Body>
void for_each_block(std::size_t n, Body&& body) {
    for_each_item(block_count(n), shares_of(n),
                  [&](std::size_t b, std::size_t) { body(b * block_size, std::min((b + 1) * block_size, n), b); });
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
