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

// Markers without memory: cell, number and epoch give their places by a hash, so that they can be drawn anew at any time.
// A cell has n x n sub-cells with one marker each, which keeps half the minimum distance from the borders of its own.
//
// So no marker ever stands in the stripes along these borders. Two points who meet head-on along x or z, with a stripe right
// between them, would share their markers alike however a little one steps aside: in the mean nothing pushes either on, and
// both stand for ever. Therefore the sub-cells of points are moved as a whole with each epoch, and ground is as likely to bear
// a marker in one place as in another. Those of people with bodies stand still, as these pass one another by their rule.
struct DrawnMarkers {
    GroundGrid grid;
    bool ring = false;                    // a periodic world; its first and last columns of cells have none
    std::vector<float> first_x, first_z;  // least place of each marker from the cell's middle, m; none: fixed markers
    float jitter = 0;                     // how far it may be from there, along x and along z, m
    double play = 0;                      // how far all are moved, along x and along z, at most, m
    std::uint64_t seed = 0;
    std::uint64_t epoch = 0;
    Vector2d moved = Vector2d::Zero();  // in this epoch, m
    PlacedBoxes obstacles;              // inside them there are none
    PlacedHouses houses;                // nor in these
};

struct Markers {
    GroundGrid grid;
    std::vector<double> x, z;               // fixed ones, m, ordered by cell
    std::vector<std::uint32_t> cell_start;  // markers of cell c: [cell_start[c], cell_start[c + 1])
    DrawnMarkers drawn;

    [[nodiscard]] std::size_t size() const { return x.size(); }
    [[nodiscard]] bool are_drawn() const { return !drawn.first_x.empty(); }
};

// `fixed`: throws darts, `markers_per_cell` that stay in each cell of the grid, uniformly at random under the condition
// that no two of them, in one cell or in two, are closer than `marker_min_distance`; then drops those inside obstacles and houses, so
// that free ground has the same density everywhere. The grid's border has markers too: an agent at the edge of the world
// perceives as many as elsewhere. In a periodic world the border's first and last columns have none: what lies beyond an
// end are the markers at the other, and the distance holds across the joint.
// `redrawn`: DrawnMarkers, the same conditions; `markers_per_cell` must be a square number.
// Depends on the seed alone. Throws ConfigurationError if the markers do not fit or the perception radius exceeds a
// cell.
[[nodiscard]] Markers place_markers(const Scene& scene);

// Draws the markers of an epoch.
void redraw(DrawnMarkers& drawn, std::uint64_t epoch);

// The epoch of drawn markers in a step: they are drawn anew every `marker_epoch` seconds, or in each step if that is 0.
[[nodiscard]] std::uint64_t marker_epoch(const Crowd& crowd, std::uint64_t step);

}  // namespace wade::crowd
