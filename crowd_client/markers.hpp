#pragma once
// The markers of BioCrowds: points of ground that agents claim.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "crowd_client/ground_grid.hpp"

namespace wade::crowd {

struct Markers {
    GroundGrid grid;
    std::vector<double> x, z;               // m, ordered by cell
    std::vector<std::uint32_t> cell_start;  // markers of cell c: [cell_start[c], cell_start[c + 1])

    [[nodiscard]] std::size_t size() const { return x.size(); }
};

// Throws darts, `markers_per_cell` that stay in each cell of the grid, uniformly at random under the condition that no
// two of them, in one cell or in two, are closer than `marker_min_distance`; then drops those inside obstacles, so that
// free ground has the same density everywhere. The grid's border has markers too: an agent at the edge of the world
// perceives as many as elsewhere. In a periodic world the border's first and last columns have none: what lies beyond an
// end are the markers at the other, and the distance holds across the joint.
// Depends on the seed alone. Throws ConfigurationError if the markers do not fit or the perception radius exceeds a
// cell.
[[nodiscard]] Markers place_markers(const Scene& scene);

}  // namespace wade::crowd
