#pragma once
// Spatial index of boxes: a grid in plan; each cell lists the boxes that reach into it.
//
// A query costs the cells that it spans, however many boxes there are: about two cells to a box.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "fluid_server/particles/mirror.hpp"

namespace wade::fluid {

// A box with faces normal to the axes; a bound may be infinite.
struct Box {
    static constexpr float inf = std::numeric_limits<float>::infinity();
    Vec3 lo{-inf, -inf, -inf};
    Vec3 hi{inf, inf, inf};
};

// Whether x lies in the box or on its faces; no if it is not a number.
inline bool contains(const Box& box, const Vec3& x) {
    return x[0] >= box.lo[0] && x[0] <= box.hi[0] && x[1] >= box.lo[1] && x[1] <= box.hi[1] && x[2] >= box.lo[2] &&
           x[2] <= box.hi[2];
}

// Whether x lies in the box, not on its faces.
inline bool is_inside(const Box& box, const Vec3& x) {
    return x[0] > box.lo[0] && x[0] < box.hi[0] && x[1] > box.lo[1] && x[1] < box.hi[1] && x[2] > box.lo[2] &&
           x[2] < box.hi[2];
}

// The box with all faces moved outwards by so much, m.
inline Box grown(Box box, float by) {
    for (std::size_t k = 0; k < 3; ++k) {
        box.lo[k] -= by;
        box.hi[k] += by;
    }
    return box;
}

// Numbers of boxes, ascending.
using BoxNumbers = std::vector<std::uint32_t>;

class BoxIndex {
 public:
    BoxIndex() = default;
    explicit BoxIndex(std::span<const Box> boxes);

    // Replaces `found` by all boxes that share a point of the ground with `box`, and maybe some near it.
    void find(const Box& box, BoxNumbers& found) const;

    // All boxes that have the point x, z of the ground in them or on their borders, and maybe some near it.
    [[nodiscard]] std::span<const std::uint32_t> at(float x, float z) const { return in_cell(x_.cell(x), z_.cell(z)); }

 private:
    // Along x and along z.
    struct Axis {
        float lo = 0, per_m = 0;  // m, cells per m
        std::uint32_t cells = 1;

        // Places beyond the grid, and those that are no numbers, count to its outermost cells.
        [[nodiscard]] std::uint32_t cell(float place) const {
            const float in_cells = (place - lo) * per_m;
            return static_cast<std::uint32_t>(std::min(std::max(0.0F, in_cells), static_cast<float>(cells - 1)));
        }
    };
    [[nodiscard]] std::span<const std::uint32_t> in_cell(std::uint32_t i, std::uint32_t k) const {
        const std::size_t cell = std::size_t{k} * x_.cells + i;
        return {boxes_.data() + start_[cell], boxes_.data() + start_[cell + 1]};
    }

    Axis x_, z_;
    std::vector<std::array<std::uint32_t, 2>> first_cell_;  // of each box, along x and z
    std::vector<std::uint32_t> start_{0, 0};                // of each cell in `boxes_`, and the total behind the last
    BoxNumbers boxes_;                                      // those of a cell after those of the one before
};

}  // namespace wade::fluid
