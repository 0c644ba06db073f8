#pragma once
// Bands of rows over ranks: the same bits as one process gives.
//
// Each rank has all of the grid in memory and works on its own rows. What it reads of others comes by messages:
//
//   each stage of a step    two rows of (h, eta, u, v) from the band below and the one above, of a site three; what cells
//                           of a group in several bands get (openings.hpp)
//   each step               the longest step and whether depths stayed positive, by the largest of all; of a site its wet
//                           lines, its outlets; of a recirculating channel sums by row, added up in the order of the rows
//   each frame              the first rank gets what is published, of lines where water was since the last one
//
// When the water has moved so that a band has a fifth more to do than the mean, all ranks share all rows and cut them anew.
// Without ranks nothing of this is done.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "fluid_server/ranks.hpp"
#include "fluid_server/shallow_water/grid.hpp"
#include "fluid_server/shallow_water/site/wet_lines.hpp"

namespace wade::fluid::shallow_water {

struct Band {
    Ranks* ranks = nullptr;          // null: this process has all rows
    std::size_t begin = 0, end = 0;  // rows of this rank

    std::vector<std::size_t> first_rows;                             // by rank, and the number of all rows
    std::vector<std::size_t> shared;                                 // cells of groups that lie in several bands
    Lines touched;                                                   // lines that were worked on since the last frame
    std::vector<double> to_lower, from_lower, to_upper, from_upper;  // memory
    std::vector<std::uint64_t> part, all, words;

    [[nodiscard]] bool has(std::size_t row) const { return row >= begin && row < end; }
    // Whether this rank adds up what all rows have.
    [[nodiscard]] bool counts() const { return ranks == nullptr || ranks->first(); }
};

// Values by cell or by row: those of row 0, and how far the next row's are.
struct RowField {
    void* row = nullptr;
    std::size_t pitch = 0, words = 0;  // of 8 bytes
};

// Without ranks these do nothing, or return what they were given.
double largest(const Band& band, double value);
bool all_agree(const Band& band, bool yes);
void merge(Band& band, std::vector<double>& values);  // each is of one rank, elsewhere 0
void gather_rows(Band& band, std::span<const RowField> fields, bool for_all);
void share_cells(Band& band, const Grid& grid, const std::array<RowMemory*, 3>& fields,
                 const std::vector<std::size_t>& cells);

}  // namespace wade::fluid::shallow_water
