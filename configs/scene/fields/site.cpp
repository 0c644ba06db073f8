// Keys of a site: ground, houses, water that comes and goes, shelters.

#include "configs/scene/fields/lists.hpp"

namespace wade {

namespace {

const Range on_map = from(-1e6).to(1e6);
const Range level_range = from(-500).to(9000);  // the Dead Sea's shore, Mount Everest

void polygon_field(Fields& f, MapLine& polygon, std::string_view what) {
    f.points("polygon", polygon, "m", on_map, what);
}
void line_field(Fields& f, MapLine& line, std::string_view what) {
    f.points("line", line, "m", on_map, what);
}
void name_field(Fields& f, std::string& name) {
    f.text("name", name, {}, "What messages and results call it; in a file the features' property name.");
}

constexpr std::string_view corners = "Its corners in order, at least three, or else file.";
constexpr std::string_view corners_or_line = "Its corners in order, at least three, or else line or file.";
constexpr std::string_view polygons_file = "GeoJSON with its polygons, in the site's coordinate system.";
constexpr std::string_view shapes_file = "GeoJSON with its polygon or line, in the site's coordinate system.";

}  // namespace

void fields(GroundKeys& ground, Fields& f) {
    f.path("file", ground.file,
           "Raster of heights: GeoTIFF (.tif) or ESRI ASCII (.asc), metres, square cells. gdalwarp makes one of any "
           "other.");
    f.number("level_m", ground.level, "m", level_range, "Height of a plane at the scene's origin.");
    f.number("slope_x", ground.slope_x, "", from(-10).to(10), "Rise of the plane along x, metres a metre.");
    f.number("slope_z", ground.slope_z, "", from(-10).to(10), "Rise of the plane along z, metres a metre.");
    f.points("points", ground.points, "m", on_map,
             "Points [x, height, z] of a surface that is linear between them, at least three, instead of the plane.");
}

void fields(HouseKeys& house, Fields& f) {
    name_field(f, house.name);
    f.path("file", house.file,
           "GeoJSON with the ground plans; their properties name, height_m, residents, upper_floor_m and doors stand "
           "over the keys here.");
    polygon_field(f, house.polygon, corners);
    f.number("height_m", house.height, "m", above(0).to(1000), "Height of the walls above the ground.");
    f.whole("residents", house.residents, "", from(0).to(100000), "People in it at t = 0; with file: in each.");
    f.points("doors", house.doors, "m", on_map,
             "Places of the doors on its walls; none: one at the lowest ground along its walls to the street from "
             "which a route "
             "leads to a goal.");
    f.number("upper_floor_m", house.upper_floor, "m", above(0).to(1000),
             "Height of an upper floor above the ground; none: there is none.", otherwise("none"));
}

void fields(ZoneKeys& zone, Fields& f) {
    f.path("file", zone.file, "GeoJSON with its polygons; their property n stands over the key here.");
    polygon_field(f, zone.polygon, corners);
    f.number("n", zone.n, "s/m^(1/3)", from(0).to(1), "Manning's coefficient in it.");
}

void fields(ManningKeys& manning, Fields& f) {
    f.number("n", manning.n, "s/m^(1/3)", from(0).to(1),
             "Manning's coefficient where neither raster nor zone says otherwise. Asphalt 0.02, short grass 0.03, "
             "gardens 0.05, brushwood 0.1.");
    f.path("file", manning.file, "Raster of the coefficient.");
    f.list("zones", manning.zones,
           "Polygons with a coefficient of their own; of those that overlap the last one holds.");
}

void fields(SourceKeys& source, Fields& f) {
    name_field(f, source.name);
    f.path("file", source.file,
           "GeoJSON with polygons or lines, each a source; their property discharge_m3_s stands over the keys here.");
    polygon_field(f, source.polygon, corners_or_line);
    line_field(f, source.line, "Along these points, at least two, or else polygon or file.");
    f.number("discharge_m3_s", source.discharge, "m3/s", from(0).to(1e6), "What comes in all the time.",
             otherwise("what hydrograph_csv says"));
    f.path("hydrograph_csv", source.hydrograph,
           "Table with the columns time_s and discharge_m3_s: straight between its rows, constant before and after.");
}

void fields(RainKeys& rain, Fields& f) {
    f.number("rate_mm_h", rain.rate, "mm/h", from(0).to(2000), "What falls all the time.",
             otherwise("what rate_csv says, or no rain"));
    f.path("rate_csv", rain.table, "Table with the columns time_s and rate_mm_h.");
}

void fields(OutletKeys& outlet, Fields& f) {
    name_field(f, outlet.name);
    f.choice("kind", outlet.kind,
             "free: water leaves as over a fall. stage: a large water at rest outside, such as a lake or a tide; its "
             "level is given in time; waves from inside come back inverted. wave: open water outside; the level of the "
             "incoming wave is given in time, its first value is the level at rest, and waves from inside leave.");
    f.path("file", outlet.file, shapes_file);
    polygon_field(f, outlet.polygon, corners_or_line);
    line_field(f, outlet.line, "Along these points, at least two, or else polygon or file.");
    f.number("level_m", outlet.level, "m", level_range,
             "Constant level of a stage; of a wave: the level at rest, without an incoming wave.",
             otherwise("what stage_csv says"));
    f.path("stage_csv", outlet.stage, "Table with the columns time_s and level_m, of a stage or of an incoming wave.");
}

void fields(GateKeys& gate, Fields& f) {
    name_field(f, gate.name);
    f.path("file", gate.file, "GeoJSON with its lines.");
    line_field(f, gate.line, "Along these points, at least two, or else file.");
    f.number("opens_at_s", gate.opens_at, "s", from(0).to(1e6), "When it is gone.");
}

void fields(WallKeys& wall, Fields& f) {
    name_field(f, wall.name);
    f.path("file", wall.file, "GeoJSON with its lines; their property crest_m stands over the key here.");
    line_field(f, wall.line, "Along these points, at least two, or else file.");
    f.number("crest_m", wall.crest, "m", level_range, "Level of its top, over which higher water runs.",
             otherwise("what the file says"));
}

void fields(WaterKeys& water, Fields& f) {
    f.path("file", water.file, polygons_file);
    polygon_field(f, water.polygon, "Its corners in order, at least three, or else file; neither: everywhere.");
    f.number("level_m", water.level, "m", level_range, "Height of the surface; ground above it is dry.");
}

void fields(GaugeKeys& gauge, Fields& f) {
    f.text("name", gauge.name, {},
           "What gauges.csv calls it; in a file the features' property name. None: its number, counted from 1.");
    f.path("file", gauge.file, "GeoJSON with points, each a gauge, in the site's coordinate system.");
    f.number("x_m", gauge.x, "m", on_map, "x of the gauge.", otherwise("with file: unused"));
    f.number("z_m", gauge.z, "m", on_map, "z of the gauge.", otherwise("with file: unused"));
}

void fields(ShelterKeys& shelter, Fields& f) {
    name_field(f, shelter.name);
    f.path("file", shelter.file, "GeoJSON with polygons; their properties name and capacity stand over the keys here.");
    polygon_field(f, shelter.polygon, corners);
    f.whole("capacity", shelter.capacity, "", from(0).to(10000000), "People that it has room for; 0: any number.");
    f.flag("exit", shelter.is_exit, "Whether people that get there have left the site, and count as arrived.");
}

void fields(SiteKeys& site, Fields& f) {
    f.whole("epsg", site.epsg, "", from(0).to(1000000),
            "Number of the coordinate system, a projected one in metres; 0: a plan in metres of no system.",
            otherwise("that of the ground's file"));
    f.number("origin_easting_m", site.origin_x, "m", from(-1e8).to(1e8),
             "Easting of the scene's origin. Points in a scene count from there; files have the system's coordinates.",
             otherwise("the lower left corner of the ground's raster, or 0"));
    f.number("origin_northing_m", site.origin_z, "m", from(-1e8).to(1e8), "Northing of the scene's origin.",
             otherwise("the lower left corner of the ground's raster, or 0"));
    f.object("ground", site.ground, "The ground: a raster, a plane or points.");
    f.list("houses", site.houses, "Houses, walls for the water and for people outside; never raised ground.");
    f.object("manning", site.manning, "Friction of the ground.");
    f.list("sources", site.sources, "Where water comes in, spread over a polygon or along a line.");
    f.object("rain", site.rain, "Rain on all that is no house.");
    f.list("outlets", site.outlets, "Where water leaves; elsewhere the edge of the site is a wall.");
    f.list("gates", site.gates, "Walls that are gone from a time on: a dam that breaks, a gate that opens.");
    f.list("walls", site.walls,
           "Flood walls: thin walls that higher water runs over by the law of a sharp-crested weir, and people do not "
           "cross. Of /fluid/model shallow_water.");
    f.list("water", site.water, "Water that stands at a level at t = 0.");
    f.path("water_depth_file", site.water_depth, "Raster of the water's depth at t = 0.");
    f.list(
        "gauges", site.gauges,
        "Where depth, level, velocity and discharge of the water are written in time, a row a frame, into gauges.csv.");
    f.list("shelters", site.shelters, "Where people are safe.");
    f.path("residents_csv", site.residents,
           "Table of people: x and y in the site's coordinate system and any of id, age, sex, height, mass, skill, "
           "group and leaves_at. People in a house start indoors.");
}

}  // namespace wade
