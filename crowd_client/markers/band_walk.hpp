#pragma once
// Traversal of the ground in find_motion(): the rows of cells of one thread's band, one after the other.
//
//   row of cells r + 1    claim ---.          Rows are processed one by one. The markers of a row are claimed and dealt
//   row of cells r        claim ---+-> walk   to their owners. Then walkers with all rows dealt sum up Eq. 1-3. Each
//   row of cells r - 1    (done)              thread has a band of walkers' rows and claims the markers for these, so
//                                             that no thread writes what another reads, for any number of threads.

#include <algorithm>
#include <cstdint>

#include "crowd_client/markers/claims.hpp"
#include "crowd_client/markers/markers.hpp"
#include "crowd_client/markers/walker_cells.hpp"
#include "crowd_client/markers/walkers.hpp"

namespace wade::crowd {

// Input for claiming the markers in a step.
struct Claiming {
    const WalkerCells& cells;
    const WalkerBodies* bodies;  // null: walkers without bodies
    const Markers& markers;
    const Walkers& walkers;
    double radius;  // claim distance of a walker, m
    Motion& motion;
};

// Rows of walkers' corner cells, [first, last).
struct RowBand {
    int first = 0, last = 0;
    [[nodiscard]] bool has(int row) const { return first <= row && row < last; }
};

// Entries with corner cells in a row, [first, last).
struct RowEntries {
    std::uint32_t first = 0, last = 0;
};
[[nodiscard]] inline RowEntries entries_of(const WalkerCells& cells, int row) {
    const std::size_t from = cells.grid.index(0, row);
    return {cells.start[from], cells.start[from + static_cast<std::size_t>(cells.grid.columns)]};
}

// Returns whether no walker reaches a cell.
[[nodiscard]] inline bool nobody_reaches(const WalkerCells& cells, int column, int row) {
    const int first_column = std::max(column - cells.span + 1, 0);
    for (int r = std::max(row - cells.span + 1, 0); r <= row; ++r) {
        const std::size_t first = cells.grid.index(first_column, r), last = cells.grid.index(column, r);
        if (cells.start[first] != cells.start[last + 1]) return false;
    }
    return true;
}

// Walks over a band. `Owners` keeps what the last `span` rows have dealt:
//   begin_row(claiming, band, row)         before the cells of a row
//   expect_cell(claiming, column, row)     a cell that is the next but one to be dealt
//   deal_cell(claiming, band, column, row) claims the markers of a cell and deals them out
//   finish(claiming, entry, image, row)    sums up the walker of an entry with a corner cell in `row`; image: its second
//                                          entry, or WalkerCells::none
template <typename Owners>
void walk_band(Owners& owners, const Claiming& claiming, const RowBand& band) {
    const WalkerCells& cells = claiming.cells;
    const int rows = cells.grid.rows;
    const auto deal_row = [&](int row) {
        owners.begin_row(claiming, band, row);
        if (entries_of(cells, std::max(row - cells.span + 1, 0)).first == entries_of(cells, row).last) return;
        constexpr int none = -1;
        int reached = none;  // the last reached column; its cell is dealt once the next one is on its way from memory
        for (int column = 0; column < cells.grid.columns; ++column) {
            if (nobody_reaches(cells, column, row)) continue;
            owners.expect_cell(claiming, column, row);
            if (reached != none) owners.deal_cell(claiming, band, reached, row);
            reached = column;
        }
        if (reached != none) owners.deal_cell(claiming, band, reached, row);
    };
    const auto sum_up_row = [&](int row) {
        const RowEntries entries = entries_of(cells, row);
        for (std::uint32_t e = entries.first; e < entries.last; ++e) {
            const std::uint32_t image = cells.image.empty() ? WalkerCells::none : cells.image[e];
            if (image != WalkerCells::second) owners.finish(claiming, e, image, row);
        }
    };
    if (band.first >= band.last) return;
    for (int row = band.first; row <= std::min(band.last + cells.span - 2, rows - 1); ++row) {
        deal_row(row);
        if (row - cells.span + 1 >= band.first) sum_up_row(row - cells.span + 1);
    }
    for (int row = std::max(rows - cells.span + 1, band.first); row < band.last; ++row) sum_up_row(row);
}

}  // namespace wade::crowd
