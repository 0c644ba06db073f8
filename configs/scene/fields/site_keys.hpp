#pragma once
// A site as a scene file says it: numbers and points in the scene's metres, and names of files. What the files hold is read by
// `loading` into a Site (site.hpp).

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "configs/scene/site.hpp"

namespace wade {

struct GroundKeys {
    std::optional<std::string> file;  // a raster of heights
    double level = 0;
    double slope_x = 0, slope_z = 0;
    std::vector<std::array<double, 3>> points;
};

struct HouseKeys {
    std::string name;
    std::optional<std::string> file;  // polygons
    MapLine polygon;
    double height = House().height;
    int residents = House().residents;
    MapLine doors;
    std::optional<double> upper_floor;
};

struct ZoneKeys {
    std::optional<std::string> file;  // polygons
    MapLine polygon;
    double n = Roughness().n;
};
struct ManningKeys {
    double n = Roughness().n;
    std::optional<std::string> file;  // a raster
    std::vector<ZoneKeys> zones;
};

struct SourceKeys {
    std::string name;
    std::optional<std::string> file;  // polygons or lines
    MapLine polygon, line;
    std::optional<double> discharge;
    std::optional<std::string> hydrograph;  // a table
};

struct RainKeys {
    std::optional<double> rate;
    std::optional<std::string> table;
};

struct OutletKeys {
    std::string name;
    OutletKind kind = OutletKind::free;
    std::optional<std::string> file;  // polygons or lines
    MapLine polygon, line;
    std::optional<double> level;
    std::optional<std::string> stage;  // a table
};

struct GateKeys {
    std::string name;
    std::optional<std::string> file;  // lines
    MapLine line;
    double opens_at = 0;
};

struct WallKeys {
    std::string name;
    std::optional<std::string> file;  // lines
    MapLine line;
    std::optional<double> crest;
};

struct WaterKeys {
    std::optional<std::string> file;  // polygons
    MapLine polygon;
    double level = 0;
};

struct ShelterKeys {
    std::string name;
    std::optional<std::string> file;  // polygons
    MapLine polygon;
    int capacity = 0;
    bool is_exit = false;
};

struct GaugeKeys {
    std::string name;
    std::optional<std::string> file;  // points
    std::optional<double> x, z;
};

struct SiteKeys {
    std::optional<int> epsg;  // 0: a plan of its own
    std::optional<double> origin_x, origin_z;
    GroundKeys ground;
    std::vector<HouseKeys> houses;
    ManningKeys manning;
    std::vector<SourceKeys> sources;
    RainKeys rain;
    std::vector<OutletKeys> outlets;
    std::vector<GateKeys> gates;
    std::vector<WallKeys> walls;
    std::vector<WaterKeys> water;
    std::optional<std::string> water_depth;  // a raster
    std::vector<GaugeKeys> gauges;
    std::vector<ShelterKeys> shelters;
    std::optional<std::string> residents;  // a table
};

}  // namespace wade
