#include "crowd_client/markers/placed_boxes.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"

namespace wade::crowd {
namespace {

// Calls visit(cell) for each cell that lists the box.
template <typename Visit>
void visit_cells(const PlacedBoxes& boxes, const Obstacle& box, Visit&& visit) {
    const double margin = 0.5 * boxes.cell + 1e-6;  // m; the part beyond half a cell covers rounding
    const int last = boxes.column_of(box.x.hi + margin), last_row = boxes.row_of(box.z.hi + margin);
    for (int row = boxes.row_of(box.z.lo - margin); row <= last_row; ++row) {
        for (int column = boxes.column_of(box.x.lo - margin); column <= last; ++column) {
            visit(boxes.index(column, row));
        }
    }
}

// Returns about the number of cells and of entries in their lists.
double size_of(const PlacedBoxes& boxes, const Interval& x, const Interval& z) {
    const auto lines = [&](double length) { return length / boxes.cell + 3; };
    double size = lines(x.length()) * lines(z.length());
    for (const Obstacle& box : boxes.all) size += lines(box.x.length()) * lines(box.z.length());
    return size;
}

}  // namespace

PlacedBoxes place_boxes(std::vector<Obstacle> all, double cell) {
    PlacedBoxes boxes;
    boxes.all = std::move(all);
    boxes.cell = cell;
    if (boxes.all.empty()) return boxes;
    constexpr double far = std::numeric_limits<double>::infinity();
    Interval x{far, -far}, z{far, -far};
    for (const Obstacle& box : boxes.all) {
        x = {std::min(x.lo, box.x.lo), std::max(x.hi, box.x.hi)};
        z = {std::min(z.lo, box.z.lo), std::max(z.hi, box.z.hi)};
    }
    const double most = 1e6 + 16 * static_cast<double>(boxes.all.size());
    while (size_of(boxes, x, z) > most) boxes.cell *= 2;
    boxes.cells_per_metre = 1 / boxes.cell;

    boxes.x0 = x.lo - boxes.cell;
    boxes.z0 = z.lo - boxes.cell;
    boxes.columns = static_cast<int>(std::ceil(x.length() / boxes.cell)) + 2;
    boxes.rows = static_cast<int>(std::ceil(z.length() / boxes.cell)) + 2;
    boxes.start.assign(boxes.index(0, boxes.rows) + 1, 0);
    for (const Obstacle& box : boxes.all) visit_cells(boxes, box, [&](std::size_t c) { ++boxes.start[c + 1]; });
    for (std::size_t c = 1; c < boxes.start.size(); ++c) boxes.start[c] += boxes.start[c - 1];
    boxes.listed.resize(boxes.start.back());
    std::vector<std::uint32_t> next(boxes.start.begin(), boxes.start.end() - 1);
    for (std::uint32_t i = 0; i < boxes.all.size(); ++i) {
        visit_cells(boxes, boxes.all[i], [&](std::size_t c) { boxes.listed[next[c]++] = i; });
    }
    return boxes;
}

}  // namespace wade::crowd
