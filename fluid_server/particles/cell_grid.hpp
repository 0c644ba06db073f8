#pragma once
// A grid of cells that finds the particles near a box, and particles sorted by cell.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "configs/scene/scene.hpp"
#include "fluid_server/particles/mirror.hpp"
#include "fluid_server/particles/parallel.hpp"
#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

// How many cells a grid has along each axis, and what they lie over, m.
struct CellLayout {
    std::array<double, 3> lo{}, length{}, cells{};
    [[nodiscard]] double all() const { return cells[0] * cells[1] * cells[2]; }
};
[[nodiscard]] CellLayout layout_of_cells(const Scene& scene, float support_radius);

// Bytes that the cells of a grid take for so many particles, about.
[[nodiscard]] double memory_of_cells(const Scene& scene, float support_radius, double particles);

// The cells in use of a grid that is mostly empty: pages of cells in a row, each with a rank once something lies in it. Ranks
// ascend with the pages, so that cells renumbered by rank keep their order. A page is found by its hash (linear probing,
// Knuth, The Art of Computer Programming 3, 6.4), the pages of a long stretch by bisection.
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

// Rows of cells along x, as high and as wide as the support radius, cut into cells a quarter as long. The order of the cells
// winds from row to row, so that a few particles in succession lie close together, at the end of a row as well:
//
//     z ^  <-----  y = 1            y = 1 ----->        Each arrow a row; the next begins where one ends, and the next
//       |  ----->  y = 0   then     y = 0 <-----        layer of rows where one layer ends.
//
// Particles beyond the grid count to its outermost cells, which changes nothing for the search. Where the channel has many more
// cells than there may be particles, only the cells of pages in use are kept (CellPages), in the same order.
class CellGrid {
 public:
    CellGrid(const Scene& scene, float support_radius);

    // Sorts all arrays of the particles by cell, in stable order; removes particles with x <= outflow_x. Returns the
    // number removed.
    std::size_t sort(Particles& particles, float outflow_x);

    // Calls body(begin, end) for each run of sorted particles that may have some between lo and hi.
    template <typename Body>
    void for_each_run(const Vec3& lo, const Vec3& hi, Body&& body) const;

    // Calls body(shift) for each periodic shift that may bring particles between lo and hi; zero is the first.
    template <typename Body>
    void for_each_period(const Vec3& lo, const Vec3& hi, Body&& body) const;

    // The length after which the grid repeats along an axis, m; 0 where it does not.
    [[nodiscard]] double period(std::size_t axis) const {
        return periodic_[axis] ? static_cast<double>(length_[axis]) : 0.0;
    }

    // Moves a coordinate that is less than one period outside back into the grid; others stay.
    [[nodiscard]] float wrap(std::size_t axis, float v) const {
        if (periodic_[axis]) {
            v += v < origin_[axis] ? length_[axis] : 0;
            v -= v >= origin_[axis] + length_[axis] ? length_[axis] : 0;
        }
        return v;
    }

 private:
    [[nodiscard]] std::uint32_t cell_along(std::size_t axis, float v) const {
        const float cell = (v - origin_[axis]) * inverse_cell_[axis];
        return static_cast<std::uint32_t>(static_cast<int>(std::clamp(cell, 0.0F, last_cell_[axis])));
    }
    // The row of index j along y and k along z: its place in the order of rows.
    [[nodiscard]] std::uint32_t row_of(std::uint32_t j, std::uint32_t k) const {
        return k * cells_[1] + (k % 2 == 0 ? j : cells_[1] - 1 - j);
    }
    // The i-th cell of a row along x.
    template <typename Row>
    [[nodiscard]] Row cell_in_row(Row row, std::uint32_t i) const {
        return row * cells_[0] + (row % 2 == 0 ? i : cells_[0] - 1 - i);
    }
    template <typename Body>
    [[gnu::noinline]] void for_each_run_of_pages(const Vec3& lo, const Vec3& hi, Body& body) const;
    void find_cells(const Particles& p, float outflow_x);
    void find_pages(const Particles& p, float outflow_x);
    void share_cells(std::size_t n);
    void deal_out(std::uint32_t first, std::uint32_t last, std::size_t n);

    std::array<float, 3> origin_{};
    std::array<float, 3> length_{};
    std::array<float, 3> inverse_cell_{};
    std::array<float, 3> last_cell_{};  // its index
    std::array<std::uint32_t, 3> cells_{};
    std::array<bool, 3> periodic_{};
    bool sparse_ = false;
    CellPages pages_;  // if sparse
    std::vector<std::uint32_t>
        start_;  // first particle of each cell, if sparse of pages in use; the total behind the last
    std::vector<std::uint32_t> cell_of_;
    std::vector<std::uint32_t> source_;  // where the particle at a sorted place was before
    std::vector<float> room_;            // for one array of particles at a time
    std::vector<Kind> room_for_kind_;
    std::array<std::uint32_t, most_shares + 1> first_cell_{};  // of the stretch that each thread deals out to
};

template <typename Body>
void CellGrid::for_each_run(const Vec3& lo, const Vec3& hi, Body&& body) const {
    if (sparse_) [[unlikely]] {
        for_each_run_of_pages(lo, hi, body);
        return;
    }
    const std::uint32_t i0 = cell_along(0, lo[0]);
    const std::uint32_t i1 = cell_along(0, hi[0]);
    const std::uint32_t j1 = cell_along(1, hi[1]);
    const std::uint32_t k1 = cell_along(2, hi[2]);
    for (std::uint32_t k = cell_along(2, lo[2]); k <= k1; ++k) {
        for (std::uint32_t j = cell_along(1, lo[1]); j <= j1; ++j) {
            const std::uint32_t row = row_of(j, k);
            const std::uint32_t one = cell_in_row(row, i0);
            const std::uint32_t other = cell_in_row(row, i1);
            const std::uint32_t begin = start_[std::min(one, other)];
            const std::uint32_t end = start_[std::max(one, other) + std::size_t{1}];
            if (begin < end) {
                body(begin, end);
            }
        }
    }
}

// Apart from the above, so that compilers have little to inline there.
template <typename Body>
void CellGrid::for_each_run_of_pages(const Vec3& lo, const Vec3& hi, Body& body) const {
    const std::uint32_t i0 = cell_along(0, lo[0]), i1 = cell_along(0, hi[0]);
    const std::uint32_t j1 = cell_along(1, hi[1]), k1 = cell_along(2, hi[2]);
    for (std::uint32_t k = cell_along(2, lo[2]); k <= k1; ++k) {
        for (std::uint32_t j = cell_along(1, lo[1]); j <= j1; ++j) {
            const std::uint64_t row = row_of(j, k), one = cell_in_row(row, i0), other = cell_in_row(row, i1);
            const auto [first, last] = pages_.stretch(std::min(one, other), std::max(one, other));
            if (start_[first] < start_[last]) body(start_[first], start_[last]);
        }
    }
}

template <typename Body>
void CellGrid::for_each_period(const Vec3& lo, const Vec3& hi, Body&& body) const {
    const auto along = [&](std::size_t axis, auto&& visit) {
        visit(0.0F);
        if (periodic_[axis] && lo[axis] < origin_[axis]) {
            visit(-length_[axis]);
        }
        if (periodic_[axis] && hi[axis] >= origin_[axis] + length_[axis]) {
            visit(length_[axis]);
        }
    };
    along(2, [&](float z) { along(1, [&](float y) { along(0, [&](float x) { body(Vec3{x, y, z}); }); }); });
}

}  // namespace wade::fluid
