#include "configs/files/geojson.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "configs/errors/exit_code.hpp"
#include "configs/files/map_system.hpp"
#include "configs/files/text_file.hpp"
#include "configs/json/json.hpp"

namespace wade {

namespace {

std::string shown(const Json& value) {
    return value.dump({.sorted = true}).substr(0, 60);
}

class JsonReader {
 public:
    JsonReader(const std::string& name, bool plan) : name_(name), plan_(plan) {}

    MapFeatures read(const Json& document) {
        const std::string type = type_of(document);
        read_system(document);
        if (type == "FeatureCollection") {
            const Json& features = document["features"];
            if (!features.is_array()) fail("", "a FeatureCollection without features");
            for (std::size_t i = 0; i < features.size(); ++i) add(features[i], i);
        } else if (type == "Feature") {
            add(document, 0);
        } else {
            add({{"type", "Feature"}, {"geometry", document}}, 0);
        }
        check_metres();
        return std::move(found_);
    }

 private:
    [[noreturn]] void fail(const std::string& feature, const std::string& sentence) const {
        throw ConfigurationError(name_ + ": " + (feature.empty() ? "" : feature + ": ") + sentence);
    }

    [[nodiscard]] std::string type_of(const Json& object) const {
        if (!object.is_object() || !object.contains("type") || !object["type"].is_string())
            fail("", "it is no GeoJSON: there is no \"type\". Remedy: wade place import, or ogr2ogr -f GeoJSON.");
        return object["type"].get<std::string>();
    }

    // {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32756"}}, of the edition of 2008 and of GDAL.
    void read_system(const Json& document) {
        const Json& text = document["crs"]["properties"]["name"];
        if (!text.is_string()) return;
        const auto name = text.get<std::string>();
        if (name.find("CRS84") != std::string::npos)
            fail("", "its coordinates are degrees (" + name + "); " + reproject_words());
        const std::size_t colon = name.find_last_of(':');
        int number = 0;
        const char* const begin = name.data() + (colon == std::string::npos ? 0 : colon + 1);
        const auto [end, error] = std::from_chars(begin, name.data() + name.size(), number);
        if (error != std::errc() || end != name.data() + name.size()) return;
        if (const std::string fault = fault_of_system(number); !fault.empty()) fail("", fault);
        found_.epsg = number;
    }

    void add(const Json& feature, std::size_t i) {
        MapFeature made;
        made.label = "feature " + std::to_string(i);
        if (type_of(feature) != "Feature") fail(made.label, "its type is no \"Feature\".");
        const Json& properties = feature["properties"];
        if (properties.is_object()) take_properties(properties, made);
        const Json& geometry = feature["geometry"];
        if (geometry.is_null()) return;
        take_geometry(geometry, made);
        found_.features.push_back(std::move(made));
    }

    void take_properties(const Json& properties, MapFeature& made) const {
        for (const auto& [key, value] : properties.items()) {
            if (value.is_number()) made.numbers[key] = value.get<double>();
            if (value.is_string()) made.words[key] = value.get<std::string>();
        }
        const auto name = made.words.find("name");
        if (name != made.words.end() && !name->second.empty()) {
            made.name = name->second;
            made.label += " (" + made.name + ")";
        }
        const Json& doors = properties["doors"];
        if (doors.is_array()) made.doors = line_of(doors, made);
    }

    void take_geometry(const Json& geometry, MapFeature& made) const {
        const std::string type = type_of(geometry);
        const Json& coordinates = geometry["coordinates"];
        if (type == "Polygon") {
            take_rings(coordinates, made);
        } else if (type == "MultiPolygon") {
            if (!coordinates.is_array()) fail(made.label, "a MultiPolygon without coordinates.");
            for (const Json& polygon : coordinates) take_rings(polygon, made);
        } else if (type == "LineString") {
            made.line = line_of(coordinates, made);
        } else if (type == "MultiLineString" && coordinates.is_array() && coordinates.size() == 1) {
            made.line = line_of(coordinates[0], made);
        } else if (type == "Point") {
            made.line = line_of(Json::array({coordinates}), made);
            made.is_point = true;
        } else {
            fail(made.label,
                 "a geometry of type \"" + type +
                     "\"; allowed: Polygon, MultiPolygon, LineString, Point. Remedy: draw what it is for as a polygon "
                     "or a line; ogr2ogr -explodecollections takes several apart.");
        }
        if (made.polygon.rings.empty() && made.line.empty()) fail(made.label, "its geometry has no points.");
    }

    void take_rings(const Json& rings, MapFeature& made) const {
        if (!rings.is_array()) fail(made.label, "a polygon without rings.");
        for (const Json& points : rings) {
            MapLine ring = line_of(points, made);
            const auto same = [](const MapPoint& a, const MapPoint& b) { return a.x == b.x && a.z == b.z; };
            ring.erase(std::unique(ring.begin(), ring.end(), same), ring.end());
            if (ring.size() > 1 && same(ring.front(), ring.back())) ring.pop_back();
            if (ring.size() < 3)
                fail(made.label, "a ring with " + std::to_string(ring.size()) +
                                     " corners; allowed: at least 3. Remedy: take it out, or draw it anew.");
            made.polygon.rings.push_back(std::move(ring));
        }
    }

    [[nodiscard]] MapLine line_of(const Json& points, const MapFeature& made) const {
        if (!points.is_array()) fail(made.label, "its coordinates are no array of points.");
        MapLine line;
        for (const Json& point : points) {
            if (!point.is_array() || point.size() < 2 || !point[0].is_number() || !point[1].is_number())
                fail(made.label, shown(point) + " is no point; allowed: [easting, northing].");
            const MapPoint place{point[0].get<double>(), point[1].get<double>()};
            if (!(std::abs(place.x) < 1e9 && std::abs(place.z) < 1e9))
                fail(made.label, shown(point) + " is no place on a map.");
            line.push_back(place);
        }
        return line;
    }

    // Without a member crs a file is to be in degrees, says RFC 7946; most that come from GIS are in the map's metres.
    void check_metres() const {
        if (plan_ || found_.epsg || found_.features.empty()) return;
        bool degrees = true, fractions = false;
        const auto look = [&](const MapLine& line) {
            for (const MapPoint& p : line) {
                degrees = degrees && std::abs(p.x) <= 180 && std::abs(p.z) <= 90;
                fractions = fractions || std::abs(p.x * 1e4 - std::round(p.x * 1e4)) > 1e-6;
            }
        };
        for (const MapFeature& feature : found_.features) {
            look(feature.line);
            for (const MapLine& ring : feature.polygon.rings) look(ring);
        }
        if (degrees && fractions)
            fail("",
                 "it names no coordinate system (crs), and its coordinates look like degrees; " + reproject_words());
    }

    const std::string& name_;
    bool plan_;
    MapFeatures found_;
};

}  // namespace

MapFeatures parse_geojson(std::string_view text, const std::string& name, bool plan) {
    try {
        return JsonReader(name, plan).read(Json::parse(text));
    } catch (const JsonError& error) {
        if (error.fault == JsonError::Fault::syntax)
            throw ConfigurationError(name + ": not valid JSON at byte " + std::to_string(error.byte) +
                                     ": it is damaged, cut short or no GeoJSON.");
        if (error.fault == JsonError::Fault::nesting)
            throw ConfigurationError(name + ": its arrays are nested more than " + std::to_string(Json::max_depth) +
                                     " deep.");
        throw ConfigurationError(name + ": not valid JSON: a number is too large or a text is not UTF-8.");
    }
}

MapFeatures read_geojson(const std::filesystem::path& file, bool plan) {
    constexpr std::size_t longest = std::size_t{256} << 20;
    return parse_geojson(read_text_file(file, "the file " + file.string(), longest), file.string(), plan);
}

}  // namespace wade
