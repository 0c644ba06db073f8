#pragma once
// Rasters as GeoTIFF.

#include <filesystem>

#include "configs/scene/place.hpp"

namespace wade {

// Writes a raster of float32 values with its place on the map, NaN being "no data"; `epsg` 0: of no coordinate system.
// Throws std::runtime_error with the reason.
void write_geotiff(const std::filesystem::path& file, const Raster& raster, int epsg);

}  // namespace wade
