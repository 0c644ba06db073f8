#pragma once
// A grid of cells as wide as the support radius, and particles sorted by cell.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "configs/scene.hpp"
#include "fluid_server/particles.hpp"

namespace wade::fluid {

// Cells over the channel, x fastest. Particles beyond the grid count to its outermost cells, which changes nothing for
// the search: two points that are near one another stay in the same or in adjacent cells.
class CellGrid {
 public:
    CellGrid(const Scene& scene, float support_radius);

    // Sorts all arrays of the particles by cell, in stable order; drops those whose x is not greater than `outflow_x`.
    // Returns the number dropped.
    std::size_t sort(Particles& particles, float outflow_x);

    // Calls body(begin, end, shift) for each contiguous run of sorted particles in the 27 cells round p; the shift is
    // what to add to their positions across a periodic border.
    template <typename Body>
    void for_each_run(float px, float py, float pz, Body&& body) const;

    // Moves a coordinate that is less than one period outside back into the grid; others stay.
    [[nodiscard]] float wrap(std::size_t axis, float v) const {
        if (periodic_[axis]) {
            v += v < origin_[axis] ? length_[axis] : 0;
            v -= v >= origin_[axis] + length_[axis] ? length_[axis] : 0;
        }
        return v;
    }

 private:
    [[nodiscard]] int cell_along(std::size_t axis, float v) const;
    [[nodiscard]] std::size_t cell_index(int i, int j, int k) const {
        return (static_cast<std::size_t>(k) * static_cast<std::size_t>(cells_[1]) + static_cast<std::size_t>(j)) *
                   static_cast<std::size_t>(cells_[0]) +
               static_cast<std::size_t>(i);
    }

    std::array<float, 3> origin_{};
    std::array<float, 3> length_{};
    std::array<float, 3> inverse_cell_{};
    std::array<int, 3> cells_{};
    std::array<bool, 3> periodic_{};
    std::vector<std::uint32_t> start_;  // first particle of each cell, and the total behind the last
    std::vector<std::uint32_t> cell_of_;
    std::vector<std::uint32_t> source_;  // where the particle at a sorted place was before
    Particles scratch_;
};

template <typename Body>
void CellGrid::for_each_run(float px, float py, float pz, Body&& body) const {
    const int ci = cell_along(0, px);
    const int cj = cell_along(1, py);
    const int ck = cell_along(2, pz);
    const int last_x = cells_[0] - 1;
    // Calls visit(cell, shift) for the three cells along an axis, as far as they exist.
    const auto along = [&](std::size_t axis, int centre, auto&& visit) {
        const int cells = cells_[axis];
        for (int c = centre - 1; c <= centre + 1; ++c) {
            if (c >= 0 && c < cells) {
                visit(c, 0.0F);
            } else if (periodic_[axis]) {
                visit(c < 0 ? cells - 1 : 0, c < 0 ? -length_[axis] : length_[axis]);
            }
        }
    };
    along(2, ck, [&](int k, float shift_z) {
        along(1, cj, [&](int j, float shift_y) {
            const auto run = [&](int from, int to, float shift_x) {
                body(start_[cell_index(from, j, k)], start_[cell_index(to, j, k) + 1],
                     std::array<float, 3>{shift_x, shift_y, shift_z});
            };
            if (periodic_[0] && ci == 0) {
                run(last_x, last_x, -length_[0]);
            }
            run(std::max(ci - 1, 0), std::min(ci + 1, last_x), 0.0F);
            if (periodic_[0] && ci == last_x) {
                run(0, 0, length_[0]);
            }
        });
    });
}

}  // namespace wade::fluid
