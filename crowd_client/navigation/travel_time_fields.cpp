#include "crowd_client/navigation/travel_time_fields.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace wade::crowd {
namespace {

struct Cell {
    int column = 0, row = 0;
    double x = 0, z = 0;  // of the position in it, in cells, [0, 1]
};

Cell cell_of(const TravelGrid& grid, const Vector2d& p) {
    const double x = (p.x() - grid.origin.x()) / grid.dx, z = (p.y() - grid.origin.y()) / grid.dz;
    const int column = static_cast<int>(std::clamp(std::floor(x), 0.0, grid.columns - 2.0));
    const int row = static_cast<int>(std::clamp(std::floor(z), 0.0, grid.rows - 2.0));
    return {column, row, std::clamp(x - column, 0.0, 1.0), std::clamp(z - row, 0.0, 1.0)};
}

std::optional<Vector2d> down_the_gradient(const TravelGrid& grid, const TravelTimeField& field, const Cell& cell) {
    const double* const lower = &field.travel[grid.node(cell.column, cell.row)];
    const double* const upper = lower + grid.columns;
    const double a = lower[1] - lower[0], b = upper[1] - upper[0];
    const double c = upper[0] - lower[0], d = upper[1] - lower[1];
    const Vector2d gradient((a + (b - a) * cell.z) / grid.dx, (c + (d - c) * cell.x) / grid.dz);
    const double slope = std::sqrt(gradient.squaredNorm());
    constexpr double flat = 1e-6;
    if (!(slope > flat) || !std::isfinite(slope)) return {};
    const double left = lower[0] + a * cell.x + (c + (d - c) * cell.x) * cell.z;
    return Vector2d(gradient * (-left / slope));
}

// L of the nodes around a cell, by rows of whole vectors. Nodes nearer than a cell are skipped, because a route would
// stall at them. From a node, L is slightly too large towards nodes in directions other than the grid's.
class NodesNear {
 public:
    NodesNear(const Navigation& navigation, const TravelTimeField& field, const Cell& cell, const Vector2d& p)
        : grid_(navigation.grid),
          column_(std::max(cell.column - navigation.reach, 0)),
          row_(std::max(cell.row - navigation.reach, 0)) {
        const int columns = std::min(cell.column + 1 + navigation.reach, grid_.columns - 1) + 1 - column_;
        const int rows = std::min(cell.row + 1 + navigation.reach, grid_.rows - 1) + 1 - row_;
        blocks_ = (columns + at_once - 1) / at_once;
        count_ = static_cast<std::size_t>(blocks_ * rows);
        const double nearest = std::min(grid_.dx, grid_.dz);
        for (int row = 0; row < rows; ++row) {
            const double z = grid_.origin.y() + (row_ + row) * grid_.dz - p.y();
            for (int block = 0; block < blocks_; ++block) {
                const int from = column_ + at_once * block;
                Block& all = all_[static_cast<std::size_t>(row * blocks_ + block)];
                all.fill(unreachable);
                std::copy_n(&field.travel[grid_.node(from, row_ + row)], std::min(at_once, column_ + columns - from),
                            all.begin());
#pragma omp simd
                for (int i = 0; i < at_once; ++i) {
                    const double x = grid_.origin.x() + (from + i) * grid_.dx - p.x(),
                                 length = std::sqrt(x * x + z * z);
                    all[static_cast<std::size_t>(i)] += length < nearest ? unreachable : length;
                }
            }
        }
    }

    // Returns the position of the node with the smallest L, and L; the first of equal ones. Infinite if none is left.
    std::pair<Vector2d, double> take_least() {
        double least = unreachable;
        std::size_t block = 0;
        for (std::size_t b = 0; b < count_; ++b) {
            const double here = *std::min_element(all_[b].begin(), all_[b].end());
            if (here < least) block = b;
            least = std::min(least, here);
        }
        if (!(least < unreachable)) return {Vector2d::Zero(), unreachable};
        Block& all = all_[block];
        const auto at = std::find(all.begin(), all.end(), least);
        *at = unreachable;
        const int b = static_cast<int>(block), i = static_cast<int>(at - all.begin());
        return {grid_.place(column_ + at_once * (b % blocks_) + i, row_ + b / blocks_), least};
    }

 private:
    static constexpr int at_once = 8;
    using Block = std::array<double, at_once>;

    const TravelGrid& grid_;
    int column_, row_, blocks_ = 0;
    std::size_t count_ = 0;
    std::array<Block, 512> all_;  // (2 most_reach + 2)^2 numbers
};

// Tests the nodes in the order of L, because one of the first is visible most often.
std::optional<Vector2d> towards_a_node(const Navigation& navigation, const TravelTimeField& field, const Cell& cell,
                                       const Vector2d& p) {
    NodesNear nodes(navigation, field, cell, p);
    const double margin = margin_from(navigation.sight, p);
    for (;;) {
        const auto [node, all] = nodes.take_least();
        if (!(all < unreachable)) return {};
        const Vector2d way = node - p;
        if (sees_with(navigation.sight, margin, p, p + way)) return way * (all / std::sqrt(way.squaredNorm()));
    }
}

bool goal_is_in_sight(const Navigation& navigation, const TravelTimeField& field, const Cell& cell, const Vector2d& p,
                      const Vector2d& rest) {
    if (!field.views.empty()) {
        const std::uint32_t number = navigation.grid.node(cell.column, cell.row);
        if (const View view = field.views[number]; view != View::unknown) return view == View::in_sight;
        const std::uint32_t first = field.hiding_start[number], last = field.hiding_start[number + 1];
        return in_sight(navigation.sight, p, p + rest, std::span(field.hiding).subspan(first, last - first));
    }
    return sees_along(navigation, p, rest);
}

}  // namespace

// The images of a periodic world's obstacles are known for one period ahead.
bool sees_along(const Navigation& navigation, const Vector2d& p, const Vector2d& way) {
    const double ahead = std::abs(way.x());
    const double share = navigation.period > 0 && ahead > navigation.period ? navigation.period / ahead : 1;
    return in_sight(navigation.sight, p, p + share * way);
}

std::optional<Vector2d> way_from(const Navigation& navigation, const TravelTimeField& field, const Vector2d& p,
                                 const Vector2d& rest) {
    const TravelGrid& grid = navigation.grid;
    // In a periodic world, moves p to the period where the field's goal is at the offset `rest`.
    const double period = navigation.period;
    Vector2d at = p;
    if (period > 0) {
        const double to_image = field.goal.x() - p.x();  // in (-period, period), and rest less whole periods
        double image_rest = rest.x();
        if (std::abs(rest.x()) > 1.5 * period) {
            // Into [0.5, 1.5) periods, on the side of the goal.
            image_rest = std::copysign(std::fmod(std::abs(rest.x()) - 0.5 * period, period) + 0.5 * period, rest.x());
        }
        at.x() = p.x() + std::round((to_image - image_rest) / period) * period;
    }
    const Cell cell = cell_of(grid, at);
    const bool may_go_straight = (navigation.crowding == 0 && !navigation.by_fields_alone) ||
                                 rest.squaredNorm() < navigation.start_radius * navigation.start_radius;
    if (field.has_point && may_go_straight && goal_is_in_sight(navigation, field, cell, p, rest)) return rest;
    const bool closed = (grid.closed[grid.node(cell.column, cell.row)] & TravelGrid::cell_closed) != 0;
    if (!closed) {
        if (const auto way = down_the_gradient(grid, field, cell)) return way;
    }
    return towards_a_node(navigation, field, cell, at);
}

std::vector<Vector2d> places_on_way(const Navigation& navigation, const TravelTimeField& field, const Vector2d& from,
                                    double step) {
    constexpr double longest = 100;  // m; longer routes go in circles
    std::vector<Vector2d> places{from};
    while (static_cast<double>(places.size()) * step < longest) {
        const Vector2d here = places.back(), rest = field.goal - here;
        const double length = std::sqrt(rest.squaredNorm());
        if (length <= step) return places;
        const std::optional<Vector2d> way = way_from(navigation, field, here, rest);
        if (!way) return {};
        places.push_back(here + *way * (step / std::sqrt(way->squaredNorm())));
    }
    return {};
}

}  // namespace wade::crowd
