#include "crowd_client/navigation/travel_time.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"

namespace wade::crowd {
namespace {

// The lines [first, last] strictly inside an interval.
struct Lines {
    int first = 0, last = -1;
};

Lines lines_inside(const Interval& side, double origin, double spacing, int count) {
    const double first = std::floor((side.lo - origin) / spacing) + 1,
                 last = std::ceil((side.hi - origin) / spacing) - 1;
    return {static_cast<int>(std::clamp(first, 0.0, static_cast<double>(count))),
            static_cast<int>(std::clamp(last, -1.0, count - 1.0))};
}

// Returns lines_inside() and the line before, because edges and cells reach in from there.
Lines reaching_inside(const Interval& side, double origin, double spacing, int count) {
    Lines lines = lines_inside(side, origin, spacing, count);
    if (side.hi > origin && side.lo < origin + (count - 1) * spacing) lines.first = std::max(lines.first - 1, 0);
    return lines;
}

void close_all(TravelGrid& grid, const Lines& columns, const Lines& rows, std::uint8_t bit) {
    for (int row = rows.first; row <= rows.last; ++row) {
        for (int column = columns.first; column <= columns.last; ++column) grid.closed[grid.node(column, row)] |= bit;
    }
}

class March {
 public:
    March(std::vector<double>& travel, MarchMemory& memory, const TravelGrid& grid, std::span<const double> slowness)
        : travel_(travel), queue_(memory.queue), done_(memory.done), grid_(grid), slowness_(slowness) {
        a_ = 1 / (grid.dx * grid.dx);
        b_ = 1 / (grid.dz * grid.dz);
    }

    void offer(std::uint32_t node, double time) {
        if (!(time < travel_[node])) return;
        travel_[node] = time;
        queue_.push(time, node);
    }

    // A node is in the queue once for each time that it was offered; all but the first to come out are stale.
    void run() {
        while (!queue_.empty()) {
            const std::uint32_t node = queue_.pop();
            if (done_[node] != 0) continue;
            done_[node] = 1;
            const auto stride = static_cast<std::uint32_t>(grid_.columns);
            const auto column = static_cast<int>(node % stride), row = static_cast<int>(node / stride);
            if (column > 0) update(node - 1, column - 1, row);
            if (column + 1 < grid_.columns) update(node + 1, column + 1, row);
            if (row > 0) update(node - stride, column, row - 1);
            if (row + 1 < grid_.rows) update(node + stride, column, row + 1);
        }
    }

 private:
    [[nodiscard]] bool is_closed(std::uint32_t node, TravelGrid::Bits bit) const {
        return (grid_.closed[node] & bit) != 0;
    }

    [[nodiscard]] double time_if_done(std::uint32_t node) const {
        return done_[node] != 0 ? travel_[node] : unreachable;
    }

    void update(std::uint32_t node, int column, int row) {
        if (done_[node] != 0 || is_closed(node, TravelGrid::node_closed)) return;
        const auto stride = static_cast<std::uint32_t>(grid_.columns);
        double a = unreachable, b = unreachable;
        std::uint32_t cell = node;  // between the two neighbours
        if (column + 1 < grid_.columns && !is_closed(node, TravelGrid::edge_x_closed)) a = time_if_done(node + 1);
        if (column > 0 && !is_closed(node - 1, TravelGrid::edge_x_closed) && time_if_done(node - 1) < a) {
            a = travel_[node - 1];
            cell -= 1;
        }
        if (row + 1 < grid_.rows && !is_closed(node, TravelGrid::edge_z_closed)) b = time_if_done(node + stride);
        if (row > 0 && !is_closed(node - stride, TravelGrid::edge_z_closed) && time_if_done(node - stride) < b) {
            b = travel_[node - stride];
            cell -= stride;
        }
        const double s = slowness_.empty() ? 1.0 : slowness_[node];
        const double along_one = std::min(a + s * grid_.dx, b + s * grid_.dz);
        offer(node, is_closed(cell, TravelGrid::cell_closed) ? along_one : upwind_time(a, b, s, along_one));
    }

    // T of the legend in the header.
    [[nodiscard]] double upwind_time(double a, double b, double s, double along_one) const {
        if (!std::isfinite(a) || !std::isfinite(b)) return along_one;
        const double sum = a_ + b_;
        const double rest = s * s / sum - a_ * b_ * (a - b) * (a - b) / (sum * sum);
        if (rest < 0) return along_one;
        const double time = (a_ * a + b_ * b) / sum + std::sqrt(rest);
        return time >= std::max(a, b) ? time : along_one;
    }

    std::vector<double>& travel_;
    MonotoneQueue& queue_;
    std::vector<std::uint8_t>& done_;
    const TravelGrid& grid_;
    std::span<const double> slowness_;
    double a_, b_;  // A and B of the legend
};

// Closes the nodes in the plan by the even-odd rule along each row, and the cells next to them.
void close_inside(TravelGrid& grid, const MapPolygon& plan, const Obstacle& ground) {
    const Lines rows = lines_inside(ground.z, grid.origin.y(), grid.dz, grid.rows);
    std::vector<double> crossings;
    for (int row = rows.first; row <= rows.last; ++row) {
        const double z = grid.origin.y() + row * grid.dz;
        crossings.clear();
        for (const MapLine& ring : plan.rings) {
            for (std::size_t k = 0, last = ring.size() - 1; k < ring.size(); last = k++) {
                const MapPoint &a = ring[last], &b = ring[k];
                if ((a.z > z) != (b.z > z)) crossings.push_back(a.x + (b.x - a.x) * (z - a.z) / (b.z - a.z));
            }
        }
        std::sort(crossings.begin(), crossings.end());
        for (std::size_t k = 1; k < crossings.size(); k += 2) {
            const Lines columns =
                lines_inside({crossings[k - 1], crossings[k]}, grid.origin.x(), grid.dx, grid.columns);
            close_all(grid, columns, {row, row}, std::uint8_t{TravelGrid::node_closed | TravelGrid::cell_closed});
            for (const int below : {row - 1, row}) {
                if (below < 0) continue;
                close_all(grid, {std::max(0, columns.first - 1), columns.last}, {below, below},
                          TravelGrid::cell_closed);
            }
        }
    }
}

// Closes nodes, edges and cells nearer to a side than the clearance, piece by piece, because few nodes are near a
// piece.
void close_along(TravelGrid& grid, const HouseSide& side, const Obstacle& piece, double clearance) {
    const double reach = clearance + std::max(grid.dx, grid.dz);
    const auto first = [&](double lo, double origin, double spacing) {
        return static_cast<int>(std::max(0.0, std::floor((lo - reach - origin) / spacing)));
    };
    const auto last = [&](double hi, double origin, double spacing, int count) {
        return static_cast<int>(std::min(count - 1.0, std::ceil((hi + reach - origin) / spacing)));
    };
    const int last_row = last(piece.z.hi, grid.origin.y(), grid.dz, grid.rows);
    const int last_column = last(piece.x.hi, grid.origin.x(), grid.dx, grid.columns);
    const auto is_near = [&](const Vector2d& p, const Vector2d& q) {
        return distance_between(side, p, q) < std::max(clearance, 1e-9);
    };
    for (int row = first(piece.z.lo, grid.origin.y(), grid.dz); row <= last_row; ++row) {
        for (int column = first(piece.x.lo, grid.origin.x(), grid.dx); column <= last_column; ++column) {
            const Vector2d here = grid.place(column, row), right = grid.place(column + 1, row);
            const Vector2d up = grid.place(column, row + 1), beyond = grid.place(column + 1, row + 1);
            std::uint8_t& bits = grid.closed[grid.node(column, row)];
            if (is_near(here, here)) bits |= TravelGrid::node_closed;
            const bool below = is_near(here, right), left = is_near(here, up);
            if (below) bits |= TravelGrid::edge_x_closed;
            if (left) bits |= TravelGrid::edge_z_closed;
            const bool holds_it =
                (here.array() <= side.from.array()).all() && (side.from.array() <= beyond.array()).all();
            if (below || left || holds_it || is_near(right, beyond) || is_near(up, beyond))
                bits |= TravelGrid::cell_closed;
        }
    }
}

}  // namespace

TravelGrid travel_grid(const Vector2d& origin, const Vector2d& extent, double cell) {
    const auto cells_along = [&](double length) { return std::max(1.0, std::ceil(length / cell - 1e-9)); };
    TravelGrid grid;
    grid.origin = origin;
    grid.columns = static_cast<int>(cells_along(extent.x())) + 1;
    grid.rows = static_cast<int>(cells_along(extent.y())) + 1;
    grid.dx = extent.x() / (grid.columns - 1);
    grid.dz = extent.y() / (grid.rows - 1);
    grid.closed.assign(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows), 0);
    return grid;
}

void close_box(TravelGrid& grid, const Obstacle& box) {
    const Lines columns = lines_inside(box.x, grid.origin.x(), grid.dx, grid.columns);
    const Lines rows = lines_inside(box.z, grid.origin.y(), grid.dz, grid.rows);
    const Lines from_columns = reaching_inside(box.x, grid.origin.x(), grid.dx, grid.columns);
    const Lines from_rows = reaching_inside(box.z, grid.origin.y(), grid.dz, grid.rows);
    close_all(grid, columns, rows, TravelGrid::node_closed);
    close_all(grid, from_columns, rows, TravelGrid::edge_x_closed);
    close_all(grid, columns, from_rows, TravelGrid::edge_z_closed);
    close_all(grid, from_columns, from_rows, TravelGrid::cell_closed);
}

void close_houses(TravelGrid& grid, const PlacedHouses& houses, double clearance) {
    for (std::size_t plan = 0; plan < houses.plans.size(); ++plan) {
        close_inside(grid, houses.plans[plan], houses.grounds.all[plan]);
    }
    for (std::size_t piece = 0; piece < houses.side_of.size(); ++piece) {
        close_along(grid, houses.sides[houses.side_of[piece]], houses.pieces.all[piece], clearance);
    }
}

void march(std::vector<double>& travel, MarchMemory& memory, const TravelGrid& grid, std::span<const double> slowness,
           std::span<const std::pair<std::uint32_t, double>> starts) {
    travel.assign(grid.closed.size(), unreachable);
    memory.done.assign(grid.closed.size(), 0);
    memory.queue.clear();
    March marching(travel, memory, grid, slowness);
    for (const auto& [node, time] : starts) {
        if ((grid.closed[node] & TravelGrid::node_closed) == 0) marching.offer(node, time);
    }
    marching.run();
}

}  // namespace wade::crowd
