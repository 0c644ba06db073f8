#pragma once
// Travel times over ground with obstacles: fast marching on a grid.
//
// The least time T to a goal, at the speed f(x) that can be walked at x, obeys the Eikonal equation |grad T| = 1 / f with
// T = 0 at the goal. It is solved with first-order upwind differences in the order of rising T (Sethian, A fast marching
// level set method for monotonically advancing fronts, PNAS 93, 1996). Let a and b be the smaller T of the two neighbours
// of a node along x and along z, dx and dz the distances to them, s = 1 / f:
//
//   ((T - a) / dx)^2 + ((T - b) / dz)^2 = s^2,  T >= a, b
//   with A = 1 / dx^2, B = 1 / dz^2, m = (A a + B b) / (A + B):
//   T = m + sqrt(s^2 / (A + B) - A B (a - b)^2 / (A + B)^2)           if that T is not below a and b,
//   T = min(a + s dx, b + s dz)           else, where one neighbour has no T yet, and where an obstacle reaches between them
//
// The error is of first order in the cells, O(h log(1/h)) around a goal that is a single node: start from exact times
// on a disc of fixed size. Routes run along edges from node to node and between two such edges; none crosses an
// obstacle.

#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "configs/scene/obstacle.hpp"
#include "configs/scene/scene.hpp"
#include "crowd_client/equations.hpp"
#include "crowd_client/markers/placed_houses.hpp"
#include "crowd_client/navigation/monotone_queue.hpp"

namespace wade::crowd {

// Nodes (column, row) at `origin` + (column dx, row dz); node = row * columns + column.
struct TravelGrid {
    // A node has bits for what is closed: the node itself; its edges to the next column and to the next row; the cell
    // between it and the next column and row, which counts as closed if an obstacle reaches into it.
    enum Bits : std::uint8_t { node_closed = 1, edge_x_closed = 2, edge_z_closed = 4, cell_closed = 8 };

    Vector2d origin = Vector2d::Zero();  // m
    double dx = 1, dz = 1;               // m
    int columns = 2, rows = 2;           // at least 2 each
    std::vector<std::uint8_t> closed;    // by node

    [[nodiscard]] std::uint32_t node(int column, int row) const {
        return static_cast<std::uint32_t>(row) * static_cast<std::uint32_t>(columns) +
               static_cast<std::uint32_t>(column);
    }
    [[nodiscard]] Vector2d place(int column, int row) const { return origin + Vector2d(column * dx, row * dz); }
};

// A grid without obstacles over [origin, origin + extent], its cells as square as they can be and at most `cell` wide.
// All lengths in m and above 0.
[[nodiscard]] TravelGrid travel_grid(const Vector2d& origin, const Vector2d& extent, double cell);

// Closes all that lies in, or crosses, the inside of a box. A box beyond the grid closes nothing; boxes that only touch leave
// the line between them open.
void close_box(TravelGrid& grid, const Obstacle& box);

// Closes all that lies in a house, or nearer to one of its sides than the clearance, m.
void close_houses(TravelGrid& grid, const PlacedHouses& houses, double clearance);

constexpr double unreachable = std::numeric_limits<double>::infinity();

// Working memory.
struct MarchMemory {
    MonotoneQueue queue;  // nodes with times that may still become less
    std::vector<std::uint8_t> done;
};

// Computes the travel time of each node, s; `unreachable` in obstacles and where no route leads.
//   slowness  1 / f by node, s/m, above 0; empty: 1 everywhere, so that times are route lengths in m
//   starts    nodes with known times, s; closed nodes are skipped
void march(std::vector<double>& travel, MarchMemory& memory, const TravelGrid& grid, std::span<const double> slowness,
           std::span<const std::pair<std::uint32_t, double>> starts);

}  // namespace wade::crowd
