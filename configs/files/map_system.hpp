#pragma once
// Coordinate systems of maps by their EPSG numbers.

#include <optional>
#include <string>
#include <string_view>

namespace wade {

// Returns why a system does not suit a site with lengths in metres along the ground; empty if it suits. 0: no system.
[[nodiscard]] std::string fault_of_system(int epsg);

// Returns the number in a name such as "EPSG:32632", "urn:ogc:def:crs:EPSG::32632" or
// "http://www.opengis.net/def/crs/EPSG/0/32632"; none for any other name.
[[nodiscard]] std::optional<int> epsg_of_name(std::string_view name);

// Returns the remedy for a file that the programs do not read as it is.
[[nodiscard]] std::string import_words();

// Returns the remedy for data in degrees, feet or a map of the world.
[[nodiscard]] std::string reproject_words();

}  // namespace wade
