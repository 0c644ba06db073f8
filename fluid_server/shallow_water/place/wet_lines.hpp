#pragma once
// Where the water is: only cells that are wet, or that a time step may wet, are worked on.
//
// A row is cut into lines of 8 cells, one bit each. A line is active if a cell of it, or one within two cells of it along or
// across, is wet, as each of the two stages of a step wets what is next to water. Between two cells that are dry nothing
// flows (FluxConstants::films_rest), so that cells beyond the active ones stay as they are. On a channel all lines are active.

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fluid_server/shallow_water/grid.hpp"

namespace wade::fluid::shallow_water {

class Lines {
 public:
    Lines() = default;
    // All cells of the grid, or none.
    Lines(const Grid& grid, bool all)
        : cells_(grid.nx),
          words_((cells_ + per_word * line_values - 1) / (per_word * line_values)),
          bits_(words_ * (grid.nz + 2 * beyond), 0) {
        if (!all) return;
        for (std::size_t k = 0; k < grid.nz; ++k) {
            for (std::size_t i = 0; i < grid.nx; i += line_values) set(k, i);
        }
    }

    static constexpr std::ptrdiff_t beyond = 2;  // empty rows on each side
    static constexpr std::size_t per_word = 64;

    [[nodiscard]] std::size_t words() const { return words_; }
    [[nodiscard]] std::size_t cells() const { return cells_; }
    [[nodiscard]] const std::uint64_t* row(std::ptrdiff_t k) const {
        return bits_.data() + static_cast<std::size_t>(k + beyond) * words_;
    }
    [[nodiscard]] std::uint64_t* row(std::ptrdiff_t k) {
        return bits_.data() + static_cast<std::size_t>(k + beyond) * words_;
    }
    // The line of cell i.
    void set(std::size_t k, std::size_t i) {
        const std::size_t line = i / line_values;
        row(static_cast<std::ptrdiff_t>(k))[line / per_word] |= std::uint64_t{1} << (line % per_word);
    }

    // Whether the first or one of the last two lines of a row is among them.
    [[nodiscard]] bool at_ends(std::size_t k) const {
        const std::uint64_t* const bits = row(static_cast<std::ptrdiff_t>(k));
        const std::size_t last = (cells_ - 1) / line_values, before = last > 0 ? last - 1 : 0;
        const auto has = [&](std::size_t line) { return (bits[line / per_word] >> (line % per_word) & 1U) != 0; };
        return has(0) || has(last) || has(before);
    }

    // Calls body(first cell, number of cells) for each run of lines in row k.
    template <typename Body>
    void for_each_span(std::size_t k, Body&& body) const {
        const std::uint64_t* const bits = row(static_cast<std::ptrdiff_t>(k));
        spans([bits](std::size_t w) { return bits[w]; }, body);
    }
    // The same of lines that are not in `others`.
    template <typename Body>
    void for_each_span_less(std::size_t k, const Lines& others, Body&& body) const {
        const auto at = static_cast<std::ptrdiff_t>(k);
        spans([&, at](std::size_t w) { return row(at)[w] & ~others.row(at)[w]; }, body);
    }
    // The same of lines that are in a row from k + `from` to k + `to`.
    template <typename Body>
    void for_each_span_near(std::ptrdiff_t k, std::ptrdiff_t from, std::ptrdiff_t to, Body&& body) const {
        spans(
            [&](std::size_t w) {
                std::uint64_t sum = 0;
                for (std::ptrdiff_t r = k + from; r <= k + to; ++r) sum |= row(r)[w];
                return sum;
            },
            body);
    }

 private:
    template <typename Bits, typename Body>
    void spans(const Bits& bits, Body& body) const {
        std::size_t begin = 0;
        bool open = false;
        for (std::size_t w = 0; w < words_; ++w) {
            const std::uint64_t word = bits(w);
            std::size_t at = 0;
            while (at < per_word) {
                const std::uint64_t rest = word >> at;
                if (!open) {
                    if (rest == 0) break;
                    at += static_cast<std::size_t>(std::countr_zero(rest));
                    begin = w * per_word + at;
                    open = true;
                } else {
                    const std::size_t run = static_cast<std::size_t>(std::countr_one(rest));
                    at += run;
                    if (at >= per_word) break;
                    open = false;
                    give(begin, w * per_word + at, body);
                }
            }
        }
        if (open) give(begin, words_ * per_word, body);
    }
    template <typename Body>
    void give(std::size_t begin, std::size_t end, Body& body) const {
        const std::size_t first = begin * line_values, last = end * line_values < cells_ ? end * line_values : cells_;
        if (first < last) body(first, last - first);
    }

    std::size_t cells_ = 0, words_ = 0;
    std::vector<std::uint64_t> bits_;
};

struct WetLines {
    Lines active;
    Lines always;       // active whether wet or not
    Lines wet, before;  // memory for find_active()
};

// Marks in row k of lines.wet those lines of the spans in `within` that have a wet cell, or one within two cells.
inline void mark_wet(const double* h, std::size_t k, double dry, const Lines& within, Lines& wet) {
    std::uint64_t* const bits = wet.row(static_cast<std::ptrdiff_t>(k));
    std::fill_n(bits, wet.words(), 0);
    within.for_each_span(k, [&](std::size_t first, std::size_t n) {
        for (std::size_t i = first; i < first + n; i += line_values) {
            const std::size_t m = std::min(line_values, first + n - i);
            unsigned wet_cells = 0;
            for (std::size_t j = 0; j < m; ++j) wet_cells |= static_cast<unsigned>(h[i + j] > dry) << j;
            if (wet_cells == 0) continue;
            wet.set(k, i);
            if ((wet_cells & 3U) != 0 && i > 0) wet.set(k, i - 1);
            if (wet_cells >> (line_values - 2) != 0 && i + line_values < within.cells()) wet.set(k, i + line_values);
        }
    });
}

// Row k of lines.active from lines.wet and lines.always.
inline void mark_active(std::ptrdiff_t k, WetLines& lines) {
    std::uint64_t* const to = lines.active.row(k);
    for (std::size_t w = 0; w < lines.wet.words(); ++w) {
        std::uint64_t bits = lines.always.row(k)[w];
        for (std::ptrdiff_t r = -Lines::beyond; r <= Lines::beyond; ++r) bits |= lines.wet.row(k + r)[w];
        to[w] = bits;
    }
}

}  // namespace wade::fluid::shallow_water
