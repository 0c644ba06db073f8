#pragma once
// Polygons and lines with their properties (RFC 7946).

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "configs/scene/place.hpp"

namespace wade {

// One of a polygon and a line is there, a point is a line of one. A MultiPolygon is one polygon of all its rings; holes are
// rings, too.
struct MapFeature {
    std::string label;  // for messages: "feature 3 (the mill)"
    std::string name;   // its property of this name
    MapPolygon polygon;
    MapLine line;
    bool is_point = false;
    std::map<std::string, double> numbers;     // its properties that are numbers
    std::map<std::string, std::string> words;  // and those that are words
    MapLine doors;                             // its property of this name, [[x, y], ...]

    [[nodiscard]] std::optional<double> number(const std::string& property) const {
        const auto found = numbers.find(property);
        return found == numbers.end() ? std::nullopt : std::optional(found->second);
    }
};

struct MapFeatures {
    std::vector<MapFeature> features;
    std::optional<int> epsg;  // of its coordinate system, if it names one in the member crs
};

// Features without a geometry are left out. Coordinates that look like degrees are refused, but not of a `plan`, whose metres
// belong to no coordinate system. Throws ConfigurationError that names file, feature, value and remedy.
[[nodiscard]] MapFeatures read_geojson(const std::filesystem::path& file, bool plan = false);
[[nodiscard]] MapFeatures parse_geojson(std::string_view text, const std::string& name, bool plan = false);

}  // namespace wade
