#pragma once
// How much of each cell and of each face of a grid polygons cover.
//
// Scan lines cut the polygons; what lies between the cuts is exact along the line. A face is such a line, a cell the mean of 16.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "configs/scene/site.hpp"
#include "fluid_server/shallow_water/grid.hpp"

namespace wade::fluid::shallow_water {

inline constexpr std::size_t cover_lines = 16;
// Which of 16 x 16 points of a cell are covered: by line from low z, a bit each from low x.
using CoverMask = std::array<std::uint16_t, cover_lines>;

// Shares in [0, 1], by cell k * nx + i.
std::vector<double> cover_of_cells(const Grid& grid, const std::vector<const MapPolygon*>& polygons);

struct Cover {
    std::vector<double> cell;  // by k * nx + i
    std::vector<double> face_x,
        face_z;  // of the face below a cell along x and along z: by k * (nx + 1) + i and k * nx + i
    std::vector<std::size_t> partly;  // cells that are covered in part, ascending
    std::vector<CoverMask> mask;      // of these
};
Cover cover_of(const Grid& grid, const std::vector<const MapPolygon*>& polygons);

}  // namespace wade::fluid::shallow_water
