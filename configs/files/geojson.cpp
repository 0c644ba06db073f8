#include "configs/files/geojson.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "configs/files/map_system.hpp"
#include "configs/files/polygon_validity.hpp"
#include "configs/files/text_file.hpp"

namespace wade {

namespace {

std::string shown(const Json& value) {
    return value.dump({.sorted = true}).substr(0, 60);
}

class JsonReader {
 public:
    JsonReader(const std::string& name, bool plan) : name_(name), plan_(plan) {}

    MapFeatures read(Json document) {
        const std::string type = type_of(document);
        read_system(document, "");
        if (type == "FeatureCollection") {
            Json* const features = document.find("features");
            if (!features || !features->is_array()) fail("", "a FeatureCollection without features.");
            for (std::size_t i = 0; i < features->size(); ++i) {
                add((*features)[i], i);
                (*features)[i] = Json();  // read, so that its memory serves the next
            }
        } else if (type == "Feature") {
            add(document, 0);
        } else {
            Json feature{{"type", "Feature"}};
            feature["geometry"] = std::move(document);
            add(feature, 0);
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
            fail("", "it is no GeoJSON: there is no \"type\". Remedy: wade site import, or ogr2ogr -f GeoJSON.");
        return object["type"].get<std::string>();
    }

    // The member crs of the GeoJSON of 2008 and of GDAL, also of a feature or geometry, and coordRefSys of JSON-FG:
    // {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32756"}}, {"type": "EPSG", "properties": {"code": 32756}} or
    // "http://www.opengis.net/def/crs/EPSG/0/32756".
    void read_system(const Json& object, const std::string& feature) {
        constexpr std::array<std::string_view, 6> others{"crs", "coordrefsys",      "srid",
                                                         "srs", "spatialreference", "epsg"};
        for (const auto& [name, value] : object.items()) {
            std::string lower = name;
            for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
            if (name == "crs" || name == "coordRefSys" ||
                std::find(others.begin(), others.end(), lower) == others.end())
                continue;
            fail(feature, "its member " + name + " names a system; allowed: crs or coordRefSys. " + reproject_words());
        }
        for (const char* const member : {"crs", "coordRefSys"}) {
            const Json& system = object[member];
            if (system.is_null()) continue;
            const Json& code = system["properties"]["code"];
            const bool is_number = system["type"] == "EPSG" && code.is_number_integer();
            const Json& text = system.is_string() ? system : system["properties"]["name"];
            const std::string name = is_number          ? "EPSG:" + code.dump()
                                     : text.is_string() ? text.get<std::string>()
                                                        : std::string();
            if (name.find("CRS84") != std::string::npos)
                fail(feature, "its coordinates are degrees (" + name + "); " + reproject_words());
            const std::optional<int> number = epsg_of_name(name);
            if (!number)
                fail(feature, std::string(member) + " is " + shown(system) +
                                  ", which gives no EPSG number of a system; " + reproject_words());
            if (const std::string fault = fault_of_system(*number); !fault.empty()) fail(feature, fault);
            if (found_.epsg && *found_.epsg != *number)
                fail(feature, "it is in EPSG:" + std::to_string(*number) +
                                  ", and the file in EPSG:" + std::to_string(*found_.epsg) + "; allowed: one system.");
            found_.epsg = number;
        }
    }

    void add(Json& feature, std::size_t i) {
        MapFeature made;
        made.label = "feature " + std::to_string(i);
        if (type_of(feature) != "Feature") fail(made.label, "its type is no \"Feature\".");
        read_system(feature, made.label);
        if (Json* const properties = feature.find("properties"); properties && !properties->is_null()) {
            if (!properties->is_object())
                fail(made.label, "properties: expected an object, found " + shown(*properties) + " (" +
                                     properties->type_name() + ").");
            take_properties(*properties, made);
        }
        const Json& geometry = std::as_const(feature)["geometry"];
        if (geometry.is_null()) {
            if (!std::as_const(made.properties)["residents"].is_null())
                fail(made.label, "it has residents and no geometry. Remedy: draw it, or take it out.");
            return;
        }
        take_geometry(geometry, made);
        found_.features.push_back(std::move(made));
    }

    void take_properties(Json& properties, MapFeature& made) const {
        made.properties = std::move(properties);
        const Json& name = std::as_const(made.properties)["name"];
        if (name.is_string() && name.size() > 0) {
            made.name = name.get<std::string>();
            made.label += " (" + made.name.substr(0, 60) + ")";
        }
        if (!name.is_null() && !name.is_string())
            fail(made.label, "name: expected a string, found " + shown(name) + " (" + name.type_name() + ").");
        const Json& doors = std::as_const(made.properties)["doors"];
        if (doors.is_null()) return;
        if (!doors.is_array())
            fail(made.label, "doors: expected an array of points [easting, northing], found " + shown(doors) + " (" +
                                 doors.type_name() + ").");
        made.doors = line_of(doors, made);
    }

    void take_geometry(const Json& geometry, MapFeature& made) {
        read_system(geometry, made.label);
        const std::string type = type_of(geometry);
        const Json& coordinates = geometry["coordinates"];
        if (type == "Polygon") {
            take_parts({{take_rings(coordinates, made)}}, made);
        } else if (type == "MultiPolygon") {
            if (!coordinates.is_array()) fail(made.label, "a MultiPolygon without coordinates.");
            std::vector<MapPolygon> parts;
            for (const Json& polygon : coordinates) parts.push_back({take_rings(polygon, made)});
            take_parts(std::move(parts), made);
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

    [[nodiscard]] std::vector<MapLine> take_rings(const Json& rings, const MapFeature& made) const {
        if (!rings.is_array()) fail(made.label, "a polygon without rings.");
        std::vector<MapLine> found;
        for (const Json& points : rings) {
            MapLine ring = line_of(points, made);
            const auto same = [](const MapPoint& a, const MapPoint& b) { return a.x == b.x && a.z == b.z; };
            ring.erase(std::unique(ring.begin(), ring.end(), same), ring.end());
            if (ring.size() > 1 && same(ring.front(), ring.back())) ring.pop_back();
            if (ring.size() < 3)
                fail(made.label, "a ring with " + std::to_string(ring.size()) +
                                     " corners; allowed: at least 3. Remedy: take it out, or draw it anew.");
            found.push_back(std::move(ring));
        }
        return found;
    }

    void take_parts(std::vector<MapPolygon> parts, MapFeature& made) {
        constexpr std::size_t longest = 100'000;  // as of a lake or zone, which have most
        std::size_t corners = 0;
        for (const MapPolygon& part : parts) {
            for (const MapLine& ring : part.rings) corners += ring.size();
        }
        if (corners > longest)
            fail(made.label, "it has " + std::to_string(corners) + " corners; allowed: <= " + std::to_string(longest) +
                                 ". Remedy: ogr2ogr -simplify 0.1.");
        if (const std::string fault = validity_.fault_of(parts); !fault.empty()) fail(made.label, fault);
        for (MapPolygon& part : parts) {
            for (MapLine& ring : part.rings) made.polygon.rings.push_back(std::move(ring));
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
    PolygonValidity validity_;
    MapFeatures found_;
};

}  // namespace

MapFeatures parse_geojson(std::string_view text, const std::string& name, bool plan) {
    try {
        const std::size_t most = std::max(std::size_t{2'000'000}, text.size() / 6);
        return JsonReader(name, plan).read(Json::parse(text, {.unique_keys = true, .max_values = most}));
    } catch (const JsonError& error) {
        if (error.fault == JsonError::Fault::syntax)
            throw ConfigurationError(name + ": not valid JSON at byte " + std::to_string(error.byte) +
                                     ": it is damaged, cut short or no GeoJSON.");
        if (error.fault == JsonError::Fault::nesting)
            throw ConfigurationError(name + ": its arrays are nested more than " + std::to_string(Json::max_depth) +
                                     " deep.");
        if (error.fault == JsonError::Fault::duplicate_key)
            throw ConfigurationError(name + ": " + error.what() + "; allowed: once. Remedy: take one out.");
        if (error.fault == JsonError::Fault::size)
            throw ConfigurationError(name +
                                     ": it has more values than coordinates of a map fill; allowed: up to one for 6 "
                                     "bytes. Remedy: ogr2ogr -spat WEST SOUTH EAST NORTH keeps those of the site.");
        throw ConfigurationError(name + ": not valid JSON: a number is too large or a text is not UTF-8.");
    }
}

MapFeatures read_geojson(const std::filesystem::path& file, bool plan) {
    constexpr std::size_t longest = std::size_t{256} << 20;
    return parse_geojson(read_text_file(file, "the file " + file.string(), longest), file.string(), plan);
}

}  // namespace wade
