#pragma once
// A site as particles meet it: the world's rectangle, houses, gates, and the ground on cells of a few particle spacings.
//
// [A] Water does not rise above walls, as in the shallow water: their height is not asked for.

#include <array>
#include <cstddef>
#include <vector>

#include "configs/scene/interval.hpp"
#include "configs/scene/scene.hpp"
#include "configs/scene/site.hpp"

namespace wade::fluid {

// A surface through points: Delaunay's triangulation, straight within each triangle.
class Triangles {
 public:
    // points: x, y, z, m; y is the height. Bowyer (1981) and Watson (1981): point by point, which is quadratic in their number
    // at worst.
    explicit Triangles(const std::vector<std::array<double, 3>>& points);

    // Outside of the triangles the height of the nearest point; NaN without points.
    [[nodiscard]] double height_at(const MapPoint& p) const;

 private:
    using Corners = std::array<std::size_t, 3>;
    [[nodiscard]] bool in_circle(const Corners& t, const MapPoint& p) const;

    std::vector<MapPoint> place_;  // three corners that hold all, then the points
    std::vector<double> height_;
    std::vector<Corners> triangles_;  // turned alike
};

// Heights at the nodes of square cells that reach a cell beyond the world. A cell has two triangles, straight each:
//
//   z ^   +-----+     upper: where z rises faster than x from the cell's lower left corner
//     |   |upp/ |
//     |   | / low     Beyond the cells the ground goes on as at their edge.
//         +-----+
struct GroundGrid {
    double x = 0, z = 0;         // of node (0, 0), m
    double cell = 1;             // m
    std::size_t nx = 1, nz = 1;  // cells
    std::vector<float> height;   // of node (i, k) at k (nx + 1) + i, m
    bool is_plane = true;        // all triangles lie in one plane

    [[nodiscard]] double at_node(std::size_t i, std::size_t k) const {
        return static_cast<double>(height[k * (nx + 1) + i]);
    }
    // m.
    [[nodiscard]] double height_at(const MapPoint& p) const;
    [[nodiscard]] double lowest() const;
};

// Where particles may be: x.lo <= x <= x.hi, z.lo <= z <= z.hi, above the ground, in no house.
struct SiteShape {
    // Sides of the world in the order of `open`.
    enum Side : std::size_t { x_lo, x_hi, z_lo, z_hi };

    Interval x, z;                   // m
    std::array<bool, 4> open{};      // sides without a wall: particles leave there
    std::vector<MapPolygon> houses;  // even-odd each; may touch, overlap and reach beyond the world
    std::vector<Barrier> gates;      // walls as thin as nothing until they open
    GroundGrid ground;
};

// A side is open if a free outlet is at all of it but houses. Ground cells are as long as three particle spacings, or twice the
// raster's cells where those are longer than that; a plane's are as long as the world.
[[nodiscard]] SiteShape site_shape(const Scene& scene);

[[nodiscard]] bool in_house(const SiteShape& shape, const MapPoint& p);

}  // namespace wade::fluid
