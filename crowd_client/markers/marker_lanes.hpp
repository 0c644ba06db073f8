#pragma once
// The markers of one cell, side by side for the lanes of a vector.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "crowd_client/markers/lanes.hpp"
#include "crowd_client/markers/markers.hpp"

namespace wade::crowd {

// Coordinates count from `origin`: for double 0, so that the arithmetic is that of the world's coordinates, for float
// the cell's middle, so that they keep 0.1 um. Entries from `count` on, up to a whole vector, lie out of reach.
template <typename Real>
struct MarkerLanes {
    std::size_t count = 0;
    double origin_x = 0, origin_z = 0;  // m
    std::vector<Real> x, z;             // m
    std::vector<std::uint8_t> crossed;  // working memory
};

// Reads fixed markers.
void read_markers(MarkerLanes<double>& lanes, const Markers& markers, int column, int row);

// Draws the markers of a cell by a hash; see DrawnMarkers. Their positions are those before the shift of the epoch.
void draw_markers(MarkerLanes<float>& lanes, const DrawnMarkers& drawn, int column, int row);

inline void markers_of(MarkerLanes<double>& lanes, const Markers& m, int column, int row) {
    read_markers(lanes, m, column, row);
}
inline void markers_of(MarkerLanes<float>& lanes, const Markers& m, int column, int row) {
    draw_markers(lanes, m.drawn, column, row);
}

}  // namespace wade::crowd
