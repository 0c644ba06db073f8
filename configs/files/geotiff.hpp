#pragma once
// Rasters as GeoTIFF.

#include <cstddef>
#include <filesystem>
#include <span>

namespace wade {

// Values on the cells of a map, row by row from the southern one, NaN being "no data".
struct MapImage {
    double x = 0, z = 0;    // easting and northing of the lower left corner, m
    double dx = 1, dz = 1;  // size of a cell, m
    std::size_t columns = 0, rows = 0;
    std::span<const float> values;
};

// Writes a map as GeoTIFF; `epsg` is the number of its coordinate system, 0: it has none. Throws std::runtime_error with the
// reason.
void write_geotiff(const std::filesystem::path& file, const MapImage& image, int epsg);

}  // namespace wade
