#pragma once
// Rasters as others write them.

#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "configs/scene/place.hpp"

namespace wade {

// What a file holds: values with NaN where it says that there is none, x and z being easting and northing.
struct RasterFile {
    Raster raster;
    std::optional<int> epsg;  // of its coordinate system, if it names one
};

inline constexpr double no_value = std::numeric_limits<double>::quiet_NaN();
inline constexpr std::size_t most_raster_cells = 100'000'000;

// A GeoTIFF or an ESRI ASCII grid, whatever its name is. Throws ConfigurationError that names file, value and remedy.
[[nodiscard]] RasterFile read_raster(const std::filesystem::path& file);

// The same for bytes that are at hand; `name` is that of the file.
[[nodiscard]] RasterFile read_esri_ascii(std::string_view text, const std::string& name);
[[nodiscard]] RasterFile read_geotiff(std::string_view bytes, const std::string& name);

// The system with this number, if lengths in it are no metres of the ground: a sentence, else empty.
[[nodiscard]] std::string fault_of_system(int epsg);

// What to do with data in degrees.
[[nodiscard]] std::string reproject_words();

}  // namespace wade
