#pragma once
// Square cells of 2 x 2 m over the world, with a border of at least one cell all round it.
//
// The border holds the markers that agents at the edge of the world perceive and the water that touches them there, and
// it lets the 3 x 3 cells round any agent exist without a check.

#include <cmath>
#include <cstddef>

#include "configs/scene/scene.hpp"
#include "configs/scene/world.hpp"

namespace wade::crowd {

struct GroundGrid {
    static constexpr double cell_size = 2.0;  // m

    int columns = 3;
    int rows = 3;

    [[nodiscard]] static GroundGrid over(const World& world) {
        return {static_cast<int>(std::floor(world.length / cell_size)) + 3,
                static_cast<int>(std::floor(world.width / cell_size)) + 3};
    }

    // The column of x and the row of z; inside the border for points of the world. The argument must be finite.
    [[nodiscard]] static int line_of(double coordinate) {
        return static_cast<int>(std::floor(coordinate / cell_size)) + 1;
    }

    [[nodiscard]] std::size_t index(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
    }
    [[nodiscard]] std::size_t cell_of(double x, double z) const { return index(line_of(x), line_of(z)); }
    [[nodiscard]] std::size_t cells() const {
        return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    }

    // Lower edge of a column or row, m; the grid spans [line_start(0), line_start(columns)) along x.
    [[nodiscard]] static double line_start(int line) { return (line - 1) * cell_size; }
};

}  // namespace wade::crowd
