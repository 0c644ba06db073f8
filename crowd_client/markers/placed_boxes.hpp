#pragma once
// Boxes with a spatial index.
//
// The rectangle around all boxes is divided into square cells. Each cell lists, in their order, the boxes nearer to it
// than half a cell. A query at most a cell wide reads one list, of the cell that holds the query's middle; a wider one
// merges the lists of the cells that it touches. The outermost cells count for everything beyond them.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/scene.hpp"

namespace wade::crowd {

struct PlacedBoxes {
    static constexpr double usual_cell = 2.0;  // m

    std::vector<Obstacle> all;

    double cell = usual_cell;                 // side of a cell, m
    double cells_per_metre = 1 / usual_cell;  // 1 / cell
    double x0 = 0, z0 = 0;                    // lower corner of the first, m
    int columns = 0, rows = 0;
    std::vector<std::uint32_t> start;   // boxes near cell c: [start[c], start[c + 1]) of `listed`
    std::vector<std::uint32_t> listed;  // indices in `all`, ascending within a cell

    // Coordinates must be finite.
    [[nodiscard]] int column_of(double x) const { return line_of(x - x0, columns); }
    [[nodiscard]] int row_of(double z) const { return line_of(z - z0, rows); }
    [[nodiscard]] std::size_t index(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
    }

 private:
    [[nodiscard]] int line_of(double along, int lines) const {
        return static_cast<int>(std::clamp(along * cells_per_metre, 0.0, lines - 1.0));
    }
};

// cell: side of the cells, m; they are made wider where they and their lists would need more than a few MB.
[[nodiscard]] PlacedBoxes place_boxes(std::vector<Obstacle> boxes, double cell = PlacedBoxes::usual_cell);

// Returns whether `test(box)` is true for a box that overlaps or touches the rectangle x, z, m. Tests the boxes in
// their order, each once, until one is found.
template <typename Test>
bool any_near(const PlacedBoxes& boxes, const Interval& x, const Interval& z, Test&& test) {
    if (boxes.all.empty()) return false;
    const auto holds = [&](const Obstacle& box) {
        const bool is_near = box.x.lo <= x.hi && box.x.hi >= x.lo && box.z.lo <= z.hi && box.z.hi >= z.lo;
        return is_near && test(box);
    };
    if (x.length() <= boxes.cell && z.length() <= boxes.cell) {
        const std::size_t c = boxes.index(boxes.column_of(0.5 * (x.lo + x.hi)), boxes.row_of(0.5 * (z.lo + z.hi)));
        for (std::uint32_t i = boxes.start[c]; i < boxes.start[c + 1]; ++i) {
            if (holds(boxes.all[boxes.listed[i]])) return true;
        }
        return false;
    }
    const int first = boxes.column_of(x.lo), last = boxes.column_of(x.hi);
    const int first_row = boxes.row_of(z.lo), last_row = boxes.row_of(z.hi);
    const auto cells = static_cast<std::size_t>(last - first + 1) * static_cast<std::size_t>(last_row - first_row + 1);
    if (cells >= boxes.all.size()) return std::any_of(boxes.all.begin(), boxes.all.end(), holds);
    // The next box of the merged lists has the smallest index from `from` on.
    for (std::uint32_t from = 0;;) {
        auto next = static_cast<std::uint32_t>(boxes.all.size());
        for (int row = first_row; row <= last_row; ++row) {
            for (int column = first; column <= last; ++column) {
                const std::uint32_t* const list = boxes.listed.data() + boxes.start[boxes.index(column, row)];
                const std::uint32_t* const end = boxes.listed.data() + boxes.start[boxes.index(column, row) + 1];
                const std::uint32_t* const found = std::lower_bound(list, end, from);
                if (found != end) next = std::min(next, *found);
            }
        }
        if (next == boxes.all.size()) return false;
        if (holds(boxes.all[next])) return true;
        from = next + 1;
    }
}

// Calls visit(box) for each of these boxes.
template <typename Visit>
void for_each_near(const PlacedBoxes& boxes, const Interval& x, const Interval& z, Visit&& visit) {
    any_near(boxes, x, z, [&](const Obstacle& box) {
        visit(box);
        return false;
    });
}

}  // namespace wade::crowd
