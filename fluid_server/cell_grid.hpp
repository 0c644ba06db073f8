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

    // Calls body(begin, end, shift_x, shift_z) for each contiguous run of sorted particles in the 27 cells round p;
    // the shifts are what to add to their positions across a periodic border.
    template <typename Body>
    void for_each_run(float px, float py, float pz, Body&& body) const;

    [[nodiscard]] float period_x() const { return periodic_[0] ? length_[0] : 0; }
    [[nodiscard]] float period_z() const { return periodic_[2] ? length_[2] : 0; }
    [[nodiscard]] float origin_x() const { return origin_[0]; }
    [[nodiscard]] float origin_z() const { return origin_[2]; }

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
    for (int k = ck - 1; k <= ck + 1; ++k) {
        int kk = k;
        float shift_z = 0;
        if (k < 0 || k >= cells_[2]) {
            if (!periodic_[2]) {
                continue;
            }
            kk = k < 0 ? cells_[2] - 1 : 0;
            shift_z = k < 0 ? -length_[2] : length_[2];
        }
        for (int j = std::max(cj - 1, 0); j <= std::min(cj + 1, cells_[1] - 1); ++j) {
            const auto run = [&](int from, int to, float shift_x) {
                body(start_[cell_index(from, j, kk)], start_[cell_index(to, j, kk) + 1], shift_x, shift_z);
            };
            if (periodic_[0] && ci == 0) {
                run(last_x, last_x, -length_[0]);
            }
            run(std::max(ci - 1, 0), std::min(ci + 1, last_x), 0.0F);
            if (periodic_[0] && ci == last_x) {
                run(0, 0, length_[0]);
            }
        }
    }
}

}  // namespace wade::fluid
