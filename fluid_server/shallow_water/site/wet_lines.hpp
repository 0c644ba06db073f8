#pragma once
// Where the water is: only cells that are wet, or that a time step may wet, are worked on.
//
// A row is cut into lines of 8 cells, one bit each. A line is active if a cell of it is wet, or one beside it is, as a step wets
// what is next to water. Between two cells that are dry nothing
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
    // The line of cell i of row k.
    struct Position {
        std::size_t word = 0;
        std::uint64_t bit = 0;
        friend bool operator==(const Position&, const Position&) = default;
    };
    [[nodiscard]] Position position(std::size_t k, std::size_t i) const {
        const std::size_t line = i / line_values;
        return {(k + static_cast<std::size_t>(beyond)) * words_ + line / per_word,
                std::uint64_t{1} << (line % per_word)};
    }
    void set(const Position& line) { bits_[line.word] |= line.bit; }
    void set(std::size_t k, std::size_t i) { set(position(k, i)); }
    [[nodiscard]] bool has(const Position& line) const { return (bits_[line.word] & line.bit) != 0; }
    [[nodiscard]] bool has(std::size_t k, std::size_t i) const { return has(position(k, i)); }
    [[nodiscard]] bool any(std::size_t k) const {
        const std::uint64_t* const bits = row(static_cast<std::ptrdiff_t>(k));
        return std::any_of(bits, bits + words_, [](std::uint64_t word) { return word != 0; });
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
    // The runs of lines that are not in `others`.
    template <typename Body>
    void for_each_span_less(std::size_t k, const Lines& others, Body&& body) const {
        const auto at = static_cast<std::ptrdiff_t>(k);
        spans([&, at](std::size_t w) { return row(at)[w] & ~others.row(at)[w]; }, body);
    }
    // The runs of lines that are in row k and in the next one, or in one of them alone.
    template <typename Body>
    void for_each_span_in_both(std::ptrdiff_t k, Body&& body) const {
        spans([&](std::size_t w) { return row(k)[w] & row(k + 1)[w]; }, body);
    }
    template <typename Body>
    void for_each_span_in_one(std::ptrdiff_t k, Body&& body) const {
        spans([&](std::size_t w) { return row(k)[w] ^ row(k + 1)[w]; }, body);
    }
    // The runs of lines that are in a row from k + `from` to k + `to`.
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

// Lines by where their wet cells lie.
struct WetMarks {
    Lines own;  // with a wet cell
    Lines one;  // with one, or beside one along the row

    WetMarks() = default;
    explicit WetMarks(const Grid& grid) : own(grid, false), one(grid, false) {}
};

struct WetLines {
    Lines active;
    Lines always;  // active whether wet or not
    Lines open;    // no others are
    WetMarks wet;  // memory for find_active(), and
    Lines before;
};

// Marks the wet cells of row k that lie in the lines `within`.
inline void mark_wet(const double* h, std::size_t k, double dry, const Lines& within, WetMarks& wet) {
    for (Lines* lines : {&wet.own, &wet.one}) {
        std::fill_n(lines->row(static_cast<std::ptrdiff_t>(k)), lines->words(), 0);
    }
    within.for_each_span(k, [&](std::size_t first, std::size_t n) {
        for (std::size_t i = first; i < first + n; i += line_values) {
            const std::size_t m = std::min(line_values, first + n - i);
            if (!std::any_of(h + i, h + i + m, [&](double depth) { return depth > dry; })) continue;
            for (Lines* lines : {&wet.own, &wet.one}) lines->set(k, i);
            if (i > 0 && h[i] > dry) wet.one.set(k, i - 1);
            if (i + line_values < within.cells() && h[i + line_values - 1] > dry) wet.one.set(k, i + line_values);
        }
    });
}

// Row k of lines.active: a step wets what is beside water.
inline void mark_active(std::ptrdiff_t k, WetLines& lines) {
    const WetMarks& wet = lines.wet;
    std::uint64_t* const to = lines.active.row(k);
    for (std::size_t w = 0; w < wet.own.words(); ++w) {
        to[w] = (lines.always.row(k)[w] | wet.one.row(k)[w] | wet.own.row(k - 1)[w] | wet.own.row(k + 1)[w]) &
                lines.open.row(k)[w];
    }
}

}  // namespace wade::fluid::shallow_water
