#include "crowd_client/ways/way_fields.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace wade::crowd {
namespace {

struct Cell {
    int column = 0, row = 0;
    double x = 0, z = 0;  // of the place in it, in cells, [0, 1]
};

Cell cell_of(const TravelGrid& grid, const Vector2d& p) {
    const double x = (p.x() - grid.origin.x()) / grid.dx, z = (p.y() - grid.origin.y()) / grid.dz;
    const int column = static_cast<int>(std::clamp(std::floor(x), 0.0, grid.columns - 2.0));
    const int row = static_cast<int>(std::clamp(std::floor(z), 0.0, grid.rows - 2.0));
    return {column, row, std::clamp(x - column, 0.0, 1.0), std::clamp(z - row, 0.0, 1.0)};
}

std::optional<Vector2d> down_the_gradient(const TravelGrid& grid, const WayField& field, const Cell& cell) {
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

// Few nodes are tested for sight, as those behind the best one so far are not. Nodes nearer than a cell are passed over, as
// the way would end there: from a node, those that the grid has in other directions look a little farther than they are.
std::optional<Vector2d> towards_a_node(const Navigation& navigation, const WayField& field, const Cell& cell,
                                       const Vector2d& p) {
    const TravelGrid& grid = navigation.grid;
    const int reach = navigation.reach;
    const double clearance = navigation.sight.clearance;
    const Vector2d lo = grid.place(cell.column - reach, cell.row - reach);
    const Vector2d hi = grid.place(cell.column + 1 + reach, cell.row + 1 + reach);
    const Interval near_x{lo.x() - clearance, hi.x() + clearance}, near_z{lo.y() - clearance, hi.y() + clearance};
    double margin = clearance;
    for_each_near(navigation.sight.boxes, near_x, near_z,
                  [&](const Obstacle& box) { margin = margin_at(box, margin, p); });
    const auto sees = [&](const Vector2d& q) {
        return !any_near(navigation.sight.boxes, near_x, near_z,
                         [&](const Obstacle& box) { return crosses(grown(box, margin), p, q); });
    };
    const double nearest = std::min(grid.dx, grid.dz);
    std::optional<Vector2d> best;
    double least = unreachable;
    for (int row = std::max(cell.row - reach, 0); row <= std::min(cell.row + 1 + reach, grid.rows - 1); ++row) {
        for (int column = std::max(cell.column - reach, 0);
             column <= std::min(cell.column + 1 + reach, grid.columns - 1); ++column) {
            const double travel = field.travel[grid.node(column, row)];
            if (!(travel < least)) continue;
            const Vector2d way = grid.place(column, row) - p;
            const double length = std::sqrt(way.squaredNorm()), all = travel + length;
            if (!(all < least) || length < nearest || !sees(p + way)) continue;
            least = all;
            best = way * (all / length);
        }
    }
    return best;
}

bool goal_is_in_sight(const Navigation& navigation, const WayField& field, const Cell& cell, const Vector2d& p,
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

// The images of a periodic world's obstacles are known for as far as a lap ahead.
bool sees_along(const Navigation& navigation, const Vector2d& p, const Vector2d& way) {
    const double ahead = std::abs(way.x());
    const double share = navigation.period > 0 && ahead > navigation.period ? navigation.period / ahead : 1;
    return in_sight(navigation.sight, p, p + share * way);
}

std::optional<Vector2d> way_from(const Navigation& navigation, const WayField& field, const Vector2d& p,
                                 const Vector2d& rest) {
    const TravelGrid& grid = navigation.grid;
    // In a periodic world, the lap in which the field's goal is where it should be.
    const double period = navigation.period;
    Vector2d at = p;
    if (period > 0) {
        const double to_image = field.goal.x() - p.x();  // in (-period, period), and rest less whole laps
        double image_rest = rest.x();
        if (std::abs(rest.x()) > 1.5 * period) {
            // Into [0.5, 1.5) laps, on the side of the goal.
            image_rest = std::copysign(std::fmod(std::abs(rest.x()) - 0.5 * period, period) + 0.5 * period, rest.x());
        }
        at.x() = p.x() + std::round((to_image - image_rest) / period) * period;
    }
    const Cell cell = cell_of(grid, at);
    const bool may_go_straight =
        navigation.crowding == 0 || rest.squaredNorm() < navigation.start_radius * navigation.start_radius;
    if (may_go_straight && goal_is_in_sight(navigation, field, cell, p, rest)) return rest;
    const bool closed = (grid.closed[grid.node(cell.column, cell.row)] & TravelGrid::cell_closed) != 0;
    if (!closed) {
        if (const auto way = down_the_gradient(grid, field, cell)) return way;
    }
    return towards_a_node(navigation, field, cell, at);
}

}  // namespace wade::crowd
