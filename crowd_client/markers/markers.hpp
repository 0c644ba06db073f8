#pragma once
// The markers of BioCrowds: points of ground that agents claim.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "crowd_client/equations.hpp"
#include "crowd_client/markers/ground_grid.hpp"
#include "crowd_client/markers/placed_boxes.hpp"
#include "crowd_client/markers/placed_houses.hpp"

namespace wade::crowd {

// Markers that are not stored: a hash of cell, number and epoch gives their positions, so that they can be drawn again
// at any time. A cell has n x n sub-cells with one marker each. It keeps half the minimum distance from the borders of
// its sub-cell.
//
// So no marker ever stands in the stripes along these borders. Let two point agents meet head-on along x or z, with a
// stripe exactly between them. They would share their markers equally even after a small side step: in the mean nothing
// pushes either on, and both stand for ever. Therefore the sub-cells of point agents are shifted as a whole with each
// epoch, and all ground is equally likely to bear a marker. The sub-cells of people with bodies stand still, because
// bodies pass one another by their own rule.
struct DrawnMarkers {
    GroundGrid grid;
    bool ring = false;                    // a periodic world; its first and last columns of cells have none
    std::vector<float> first_x, first_z;  // least offset of each marker from the cell's middle, m; none: fixed markers
    float jitter = 0;                     // largest distance from there along x and along z, m
    double play = 0;                      // largest shift of all markers along x and along z, m
    std::uint64_t seed = 0;
    std::uint64_t epoch = 0;
    Vector2d moved = Vector2d::Zero();  // shift in this epoch, m
    PlacedBoxes obstacles;              // markers inside these are dropped
    PlacedHouses houses;                // and inside these
};

struct Markers {
    GroundGrid grid;
    std::vector<double> x, z;               // fixed ones, m, ordered by cell
    std::vector<std::uint32_t> cell_start;  // markers of cell c: [cell_start[c], cell_start[c + 1])
    DrawnMarkers drawn;

    [[nodiscard]] std::size_t size() const { return x.size(); }
    [[nodiscard]] bool are_drawn() const { return !drawn.first_x.empty(); }
};

// Places the markers.
//   `fixed`    throws darts until each cell of the grid has `markers_per_cell`, uniformly at random, with at least
//              `marker_min_distance` between any two, also across cells. Then drops markers inside obstacles and
//              houses, so that free ground has the same density everywhere. The grid's border has markers too: an agent
//              at the edge of the world perceives as many as elsewhere. In a periodic world the border's first and last
//              columns have none, as the markers of the other end lie there; the distance holds across the boundary.
//   `redrawn`  sets DrawnMarkers under the same conditions; `markers_per_cell` must be a square number.
// Depends on the seed alone. Throws ConfigurationError if the markers do not fit or the perception radius exceeds a
// cell.
[[nodiscard]] Markers place_markers(const Scene& scene);

// Draws the markers of an epoch.
void redraw(DrawnMarkers& drawn, std::uint64_t epoch);

// The epoch of drawn markers in a step: they are drawn anew every `marker_epoch` seconds, or in each step if that is 0.
[[nodiscard]] std::uint64_t marker_epoch(const Crowd& crowd, std::uint64_t step);

}  // namespace wade::crowd
