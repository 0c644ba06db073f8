#pragma once
// Walkers sorted by the cells in their reach.
//
//      +----+----+----+      A walker w that claims within R <= 1 m of its site reaches 2 x 2 cells, with R <= 2 m
//      |    |::::|::::|      3 x 3 of them (the source's R is 1 m). It is sorted under the lowest of them, its corner
//      +----+--w-+----+      cell C. So `span` runs hold the walkers that reach a cell, one for its own row and for
//      |    |C:::|::::|      each of the span - 1 rows below: `span` cells up to its own column, from the left.
//      +----+----+----+

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "crowd_client/equations.hpp"
#include "crowd_client/markers/ground_grid.hpp"

namespace wade::crowd {

struct WalkerCells {
    static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
    static constexpr std::uint32_t second = none - 1;

    GroundGrid grid;
    int span = 2;  // cells that a walker reaches along an axis
    // Entries with corner cell c: [start[c], start[c + 1]), within a cell in the order of the walkers' list.
    std::vector<std::uint32_t> start;
    std::vector<std::uint32_t> walker;  // of an entry: index in the walkers' list
    std::vector<double> x, z;           // its site, m; of an image, beyond the periodic boundary; read by copy_four()

    // Empty in an open world. A walker that reaches over the periodic boundary has two entries, the first with the
    // smaller x.
    std::vector<double> shift;         // of an entry against its walker along x, m
    std::vector<std::uint32_t> image;  // of a first entry: the second one, or none; of a second: `second`

    // Working memory.
    std::vector<std::uint32_t> cell, listed, first_entry;
    std::vector<double> listed_shift;

    [[nodiscard]] std::size_t entries() const { return walker.size(); }
};

// Sorts walkers that claim markers within `radius` (at most 2 m) of their sites. If `period` is above 0, a site that
// reaches over the periodic boundary gets an image. A site beyond the boundary is moved back into the world, while its
// walker stays beyond. Each site must be in the world or less than 2 m - radius outside. moved: of the markers, m;
// sites count from there.
void sort_walkers(WalkerCells& cells, const GroundGrid& grid, std::span<const Vector2d> sites, double radius,
                  double period, const Vector2d& moved);

// Calls body(row, first, last, before) for each run of walkers that reach a cell: the entries [first, last) with corner
// cells in `row`; `before` entries were in earlier runs.
template <typename Body>
void for_each_run(const WalkerCells& cells, int column, int row, Body&& body) {
    const int first_column = std::max(column - cells.span + 1, 0);
    std::size_t before = 0;
    for (int r = std::max(row - cells.span + 1, 0); r <= row; ++r) {
        const std::uint32_t first = cells.start[cells.grid.index(first_column, r)];
        const std::uint32_t last = cells.start[cells.grid.index(column, r) + 1];
        body(r, first, last, before);
        before += last - first;
    }
}

}  // namespace wade::crowd
