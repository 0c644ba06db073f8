#pragma once
// The ground's height at a place of the map.

#include <algorithm>
#include <cmath>

#include "configs/scene/place.hpp"

namespace wade {

// Of a raster straight between the centres of its cells, of those that have a value, constant beyond them; 0 where none has.
[[nodiscard]] inline double height_in(const Raster& raster, const MapPoint& p) {
    const auto columns = static_cast<double>(raster.columns), rows = static_cast<double>(raster.rows);
    const double x = std::clamp((p.x - raster.x) / raster.cell - 0.5, 0.0, columns - 1);
    const double z = std::clamp((p.z - raster.z) / raster.cell - 0.5, 0.0, rows - 1);
    const double column = std::min(std::floor(x), std::max(0.0, columns - 2));
    const double row = std::min(std::floor(z), std::max(0.0, rows - 2));
    double sum = 0, weights = 0;
    for (int corner = 0; corner < 4; ++corner) {
        const double i = std::min(column + corner % 2, columns - 1), k = std::min(row + corner / 2, rows - 1);
        const double weight = std::max(0.0, 1 - std::abs(x - i)) * std::max(0.0, 1 - std::abs(z - k));
        const double value = raster.at(static_cast<std::size_t>(i), static_cast<std::size_t>(k));
        if (std::isnan(value) || !(weight > 0)) continue;
        sum += weight * value;
        weights += weight;
    }
    return weights > 0 ? sum / weights : 0;
}

// m. Of points the mean by the inverse squares of their distances, without the triangles between them [A].
[[nodiscard]] inline double ground_height(const Ground& ground, const MapPoint& p) {
    if (ground.raster) return height_in(*ground.raster, p);
    if (ground.points.empty()) return ground.level + ground.slope_x * p.x + ground.slope_z * p.z;
    double sum = 0, weights = 0;
    for (const auto& [x, y, z] : ground.points) {
        const double square = (p.x - x) * (p.x - x) + (p.z - z) * (p.z - z);
        if (!(square > 1e-12)) return y;
        sum += y / square;
        weights += 1 / square;
    }
    return sum / weights;
}

}  // namespace wade
