#pragma once
// Rasters as others write them.

#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "configs/scene/site.hpp"

namespace wade {

// What a file holds: values with NaN where it says that there is none, x and z being easting and northing.
struct RasterFile {
    Raster raster;
    std::optional<int> epsg;  // of its coordinate system, if it names one
};

inline constexpr double no_value = std::numeric_limits<double>::quiet_NaN();
inline constexpr std::size_t most_raster_cells = 100'000'000;
inline constexpr std::size_t cells_of_small_file = std::size_t{1} << 24;  // a larger raster has a byte for each cell

// A GeoTIFF or an ESRI ASCII grid, whatever its name is. Files beside it (.aux.xml, .msk, .prj) that change what its values mean are
// refused. Throws ConfigurationError that names file, value and remedy.
[[nodiscard]] RasterFile read_raster(const std::filesystem::path& file);

// The same for bytes that are at hand; `name` is that of the file.
[[nodiscard]] RasterFile read_esri_ascii(std::string_view text, const std::string& name);
[[nodiscard]] RasterFile read_geotiff(std::string_view bytes, const std::string& name);

// Returns which of GDAL's metadata of a raster changes what its values mean (scale, offset, unit), with the remedy; empty if none does.
// `text` is the XML of the tag 42112 of TIFF, or that of a file .aux.xml.
[[nodiscard]] std::string fault_of_metadata(std::string_view text);

}  // namespace wade
