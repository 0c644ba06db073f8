#pragma once
// Polygons and lines with their properties (RFC 7946).

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "configs/json/json.hpp"
#include "configs/scene/site.hpp"

namespace wade {

// One of a polygon and a line is there, a point is a line of one. A MultiPolygon is one polygon of all its rings; holes are
// rings, too.
struct MapFeature {
    std::string label;  // for messages: "feature 3 (the mill)"
    std::string name;   // its property of this name
    MapPolygon polygon;
    MapLine line;
    bool is_point = false;
    Json properties;  // an object or null
    MapLine doors;    // its property of this name, [[x, y], ...]
};

struct MapFeatures {
    std::vector<MapFeature> features;
    std::optional<int> epsg;  // of its coordinate system, if it names one in the member crs
};

// Reads the features; those without a geometry are left out. Refuses coordinates that look like degrees, except in a
// `plan`, which has metres outside any coordinate system. Refuses repeated keys and invalid polygons. Throws
// ConfigurationError that names file, feature, value and remedy.
[[nodiscard]] MapFeatures read_geojson(const std::filesystem::path& file, bool plan = false);
[[nodiscard]] MapFeatures parse_geojson(std::string_view text, const std::string& name, bool plan = false);

}  // namespace wade
