#include "crowd_client/markers/walker_cells.hpp"

#include <algorithm>

#include "crowd_client/markers/lanes.hpp"

namespace wade::crowd {
namespace {

// Lists each walker once, then a second time the walkers that reach over the periodic boundary.
void list_entries(WalkerCells& cells, std::span<const Vector2d> sites, double radius, double period, double moved) {
    const std::size_t n = sites.size();
    cells.listed.resize(n);
    cells.listed_shift.assign(n, 0.0);
    const auto reaches = [&](double x) { return x > -radius && x < period + radius; };
    for (std::size_t k = 0; k < n; ++k) {
        cells.listed[k] = static_cast<std::uint32_t>(k);
        bool is_listed = reaches(sites[k].x() - moved);
        for (const double shift : {period, -period}) {
            if (!reaches(sites[k].x() - moved + shift)) continue;
            if (is_listed) {
                cells.listed.push_back(static_cast<std::uint32_t>(k));
                cells.listed_shift.push_back(shift);
            } else {
                cells.listed_shift[k] = shift;
            }
            is_listed = true;
        }
    }
}

void link_images(WalkerCells& cells, std::size_t walkers) {
    cells.image.assign(cells.entries(), WalkerCells::none);
    cells.first_entry.assign(walkers, WalkerCells::none);
    for (std::uint32_t e = 0; e < cells.entries(); ++e) {
        std::uint32_t& other = cells.first_entry[cells.walker[e]];
        if (other == WalkerCells::none) {
            other = e;
            continue;
        }
        const bool comes_first = cells.shift[e] < cells.shift[other];
        cells.image[comes_first ? e : other] = comes_first ? other : e;
        cells.image[comes_first ? other : e] = WalkerCells::second;
    }
}

}  // namespace

void sort_walkers(WalkerCells& cells, const GroundGrid& grid, std::span<const Vector2d> sites, double radius,
                  double period, const Vector2d& moved) {
    cells.grid = grid;
    cells.span = 2 * radius <= GroundGrid::cell_size ? 2 : 3;
    const bool ring = period > 0;
    if (ring) list_entries(cells, sites, radius, period, moved.x());
    const std::size_t entries = ring ? cells.listed.size() : sites.size();
    const auto walker_of = [&](std::size_t i) { return ring ? cells.listed[i] : static_cast<std::uint32_t>(i); };
    const auto shift_of = [&](std::size_t i) { return ring ? cells.listed_shift[i] : 0.0; };

    cells.cell.resize(entries);
    cells.start.assign(grid.cells() + 1, 0);
    for (std::size_t i = 0; i < entries; ++i) {
        const Vector2d site = sites[walker_of(i)] - moved;
        // An image may reach cells from beyond the grid.
        const int column = std::max(GroundGrid::line_of(site.x() + shift_of(i) - radius), 0);
        const std::size_t cell = grid.index(column, std::max(GroundGrid::line_of(site.y() - radius), 0));
        cells.cell[i] = static_cast<std::uint32_t>(cell);
        ++cells.start[cell + 1];
    }
    // start[c + 1] is the next free index of cell c while the entries are dealt out, and its end when all are.
    std::uint32_t before = 0;
    for (std::size_t c = 0; c < grid.cells(); ++c) {
        const std::uint32_t count = cells.start[c + 1];
        cells.start[c + 1] = before;
        before += count;
    }
    cells.walker.resize(entries);
    cells.x.resize(entries + beyond_fours);
    cells.z.resize(entries + beyond_fours);
    cells.shift.resize(ring ? entries : 0);
    for (std::size_t i = 0; i < entries; ++i) {
        const std::uint32_t to = cells.start[cells.cell[i] + std::size_t{1}]++;
        const std::uint32_t k = walker_of(i);
        cells.walker[to] = k;
        cells.x[to] = sites[k].x() - moved.x() + shift_of(i);
        cells.z[to] = sites[k].y() - moved.y();
        if (ring) cells.shift[to] = shift_of(i);
    }
    if (ring) link_images(cells, sites.size());
}

}  // namespace wade::crowd
