#pragma once
// Validity of polygons as OGC 06-103r4 (Simple Features) defines it.

#include <cstddef>
#include <string>
#include <vector>

#include "configs/scene/site.hpp"

namespace wade {

// Returns the polygon of a line of this width, m, with square ends and mitred corners; its holes are rings.
[[nodiscard]] MapPolygon widened(const MapLine& line, double width);

class PolygonValidity {
 public:
    // Returns what makes a polygon of several parts invalid, with the point and the remedy: edges that cross or lie on one another,
    // spikes, holes outside of their outline, parts that overlap. The first ring of a part is its outline, the others are its holes.
    // Empty for a valid polygon.
    [[nodiscard]] std::string fault_of(const std::vector<MapPolygon>& parts);

 private:
    [[nodiscard]] bool take_work(const std::vector<MapPolygon>& parts);

    std::size_t work_left_ =
        200'000'000;  // pairs of edges that share an x, so that tangled outlines cost less than 2 s
};

}  // namespace wade
