#pragma once
// The cells in use of a grid that is mostly empty: pages of cells in a row, each with a rank once something lies in it.
//
// Ranks ascend with the pages, so that cells renumbered by rank keep their order. A page is found by its hash (linear probing,
// Knuth, The Art of Computer Programming 3, 6.4), the pages of a long stretch by bisection.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace wade::fluid {

class CellPages {
 public:
    // Two pages are as long as the box that asks for neighbours, and as a cache line or two of numbers.
    static constexpr std::uint64_t cells_per_page = 32;
    static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

    // Forgets all pages, not their memory.
    void clear();
    // Notes a page; it may be there already. Ranks hold from settle() on.
    void add(std::uint64_t page) {
        if (rank(page) == none) insert(page);
    }
    void settle();

    [[nodiscard]] std::size_t count() const { return pages_.size(); }

    // The rank of a page, or none.
    [[nodiscard]] std::uint32_t rank(std::uint64_t page) const {
        for (std::size_t slot = slot_of(page);; slot = (slot + 1) & (slots_.size() - 1)) {
            const std::uint32_t at = slots_[slot];
            if (at == none || pages_[at] == page) return at;
        }
    }

    // Where the cells [first, last] begin and end among those in use; both the same if none is.
    struct Stretch {
        std::size_t begin = 0, end = 0;
    };
    [[nodiscard]] Stretch stretch(std::uint64_t first, std::uint64_t last) const;

 private:
    [[nodiscard]] std::size_t slot_of(std::uint64_t page) const {
        constexpr std::uint64_t golden = 0x9E3779B97F4A7C15;  // 2^64 over the golden ratio
        return static_cast<std::size_t>(page * golden >> shift_);
    }
    void insert(std::uint64_t page);
    void fill_slots();

    static constexpr int least_bits = 4;
    std::vector<std::uint64_t> pages_;  // ascending once settled
    std::vector<std::uint32_t> slots_ = std::vector<std::uint32_t>(std::size_t{1} << least_bits, none);
    int shift_ = 64 - least_bits;
};

inline CellPages::Stretch CellPages::stretch(std::uint64_t first, std::uint64_t last) const {
    constexpr std::uint64_t few = 4;
    const std::uint64_t from = first / cells_per_page, to = last / cells_per_page;
    std::size_t lowest = none, behind = 0;  // ranks
    if (to - from < few) {
        for (std::uint64_t page = from; page <= to; ++page) {
            const std::uint32_t at = rank(page);
            if (at == none) continue;
            lowest = std::min<std::size_t>(lowest, at);
            behind = at + std::size_t{1};
        }
    } else {
        lowest = static_cast<std::size_t>(std::lower_bound(pages_.begin(), pages_.end(), from) - pages_.begin());
        behind = static_cast<std::size_t>(std::upper_bound(pages_.begin(), pages_.end(), to) - pages_.begin());
    }
    if (lowest >= behind) return {};
    const std::size_t begin = pages_[lowest] == from ? first % cells_per_page : 0;
    const std::size_t unused = pages_[behind - 1] == to ? cells_per_page - 1 - last % cells_per_page : 0;
    return {lowest * cells_per_page + begin, behind * cells_per_page - unused};
}

}  // namespace wade::fluid
