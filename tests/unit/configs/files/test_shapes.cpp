// Polygons, lines and series of others.

#include <catch2/catch.hpp>

#include "configs/errors/exit_code.hpp"
#include "configs/files/geojson.hpp"
#include "configs/files/residents_csv.hpp"
#include "configs/files/series_csv.hpp"
#include "configs/numbers/splitmix.hpp"

namespace wade::shape_test {

const std::string two_houses = R"({"type": "FeatureCollection",
 "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32756"}},
 "features": [
  {"type": "Feature", "properties": {"name": "mill", "height_m": 7.5, "levels": null, "doors": [[382260, 6354270]]},
   "geometry": {"type": "Polygon", "coordinates": [[[382260, 6354270, 3], [382270, 6354270], [382270, 6354280], [382260, 6354270]],
                                                   [[382264, 6354271], [382266, 6354271], [382266, 6354273]]]}},
  {"type": "Feature", "properties": null, "geometry": null},
  {"type": "Feature", "properties": {}, "geometry": {"type": "LineString", "coordinates": [[382260, 6354270], [382261, 6354271]]}}]})";

std::string polygon_of(const std::string& points, const std::string& more = "") {
    return R"({"type": "Polygon", "coordinates": [[)" + points + "]]" + more + "}";
}

std::string refusal_of_shapes(const std::string& text) {
    try {
        static_cast<void>(parse_geojson(text, "h.geojson"));
    } catch (const ConfigurationError& error) {
        return error.what();
    }
    return "";
}

const Key discharge{"discharge_m3_s", KeyKind::number, "", "m3/s", from(0).to(1e6)};

std::string refusal_of_series(const std::string& text) {
    try {
        static_cast<void>(parse_series(text, "q.csv", discharge));
    } catch (const ConfigurationError& error) {
        return error.what();
    }
    return "";
}

std::uint64_t shape_bits(std::uint64_t n) {
    return mix_bits(n * splitmix_step);
}

}  // namespace wade::shape_test

using namespace wade::shape_test;
using Catch::Matchers::Contains;

TEST_CASE("GeoJSON: rings without the point that closes them, properties, system") {
    const wade::MapFeatures file = wade::parse_geojson(two_houses, "h.geojson");
    CHECK(file.epsg == 32756);
    REQUIRE(file.features.size() == 2);
    const wade::MapFeature& mill = file.features[0];
    CHECK(mill.name == "mill");
    CHECK(mill.properties["height_m"] == 7.5);
    CHECK_FALSE(mill.properties.contains("residents"));
    REQUIRE(mill.polygon.rings.size() == 2);
    CHECK((mill.polygon.rings[0].size() == 3 && mill.polygon.rings[1].size() == 3 && mill.doors.size() == 1));
    CHECK(contains(mill.polygon, {382269, 6354272}));
    CHECK_FALSE(contains(mill.polygon, {382265.5, 6354271.8}));  // in the hole
    CHECK((file.features[1].polygon.rings.empty() && file.features[1].line.size() == 2));
}

TEST_CASE("what is wrong with a GeoJSON is named with its feature and a remedy") {
    CHECK_THAT(refusal_of_shapes("{"), Contains("h.geojson: not valid JSON at byte"));
    CHECK_THAT(refusal_of_shapes("[]"), Contains("no GeoJSON"));
    CHECK_THAT(refusal_of_shapes(std::string(10000, '[')), Contains("nested") || Contains("not valid JSON"));
    CHECK_THAT(refusal_of_shapes(polygon_of("[1e3, 0], [1e3, 1], [1e3, 0]")),
               Contains("feature 0: a ring with 2 corners"));
    CHECK_THAT(refusal_of_shapes(polygon_of("[1e3, 0], [1e3, \"1\"], [2e3, 0]")), Contains("is no point"));
    CHECK_THAT(refusal_of_shapes(R"({"type": "MultiPoint", "coordinates": [[1, 2]]})"), Contains("allowed: Polygon"));
    CHECK_THAT(refusal_of_shapes(polygon_of("[151.71234567, -32.9], [151.72, -32.9], [151.72, -32.8]")),
               Contains("look like degrees") && Contains("wade site import"));
    CHECK(wade::parse_geojson(polygon_of("[1.71234567, 2], [3, 4], [5, 7]"), "flume.geojson", true).features.size() ==
          1);
    const std::string crs = R"(, "crs": {"type": "name", "properties": {"name": ")";
    CHECK_THAT(refusal_of_shapes(polygon_of("[1, 2], [3, 4], [5, 7]", crs + R"(urn:ogc:def:crs:OGC:1.3:CRS84"}})")),
               Contains("degrees"));
    CHECK_THAT(refusal_of_shapes(polygon_of("[1, 2], [3, 4], [5, 7]", crs + R"(EPSG:3857"}})")), Contains("Mercator"));
    for (const std::string other : {"CRS", "srid", "spatialReference"}) {
        CHECK_THAT(refusal_of_shapes(polygon_of("[1, 2], [3, 4], [5, 7]", ", \"" + other + "\": 4326")),
                   Contains("its member " + other + " names a system"));
    }
}

TEST_CASE("a series: columns by name, comments, jumps") {
    const wade::Series q =
        wade::parse_series("# of 2007\r\ntime_s, discharge_m3_s\r\n0,1.5\r\n60,2\r\n60,3\r\n", "q.csv", discharge);
    REQUIRE(q.size() == 3);
    CHECK((q[0].value == 1.5 && q[1].time == 60 && q[2].value == 3));
}

TEST_CASE("marks of missing data and values out of range in a series are refused with file and line") {
    const auto refusal = [](const std::string& level) {
        try {
            static_cast<void>(
                wade::parse_series("time_s,level_m\n0,1\n60," + level + "\n120,1\n", "tide.csv",
                                   {"level_m", wade::KeyKind::number, "", "m", wade::from(-1000).to(9000)}));
        } catch (const wade::ConfigurationError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    for (const std::string mark : {"-9999", "-9999.0", "-999", "-999.99", "-99", "-99999", "-32768"}) {
        CHECK_THAT(refusal(mark), Contains("tide.csv: line 3: level_m is -") && Contains("(no data)"));
    }
    for (const std::string beyond : {"-1000.5", "9999", "1e6", "1e300"}) {
        CHECK_THAT(refusal(beyond),
                   Contains("tide.csv: line 3: level_m: ") && Contains("allowed: >= -1000 and <= 9000 m."));
    }
    for (const std::string word : {"nan", "inf", "", "NA"}) {
        CHECK_THAT(refusal(word), Contains("tide.csv: line 3: level_m") && Contains("a number"));
    }
    CHECK(refusal("-10") == "");
    CHECK_THAT(refusal_of_series("time_s,discharge_m3_s\n0,-9999\n"),
               Contains("q.csv: line 2: ") && Contains("(no data)"));
}

TEST_CASE("what is wrong with a series is named with its line and a remedy") {
    const std::string head = "time_s,discharge_m3_s\n";
    CHECK_THAT(refusal_of_series(head + "0,1\n60,2\n30,3\n"),
               Contains("q.csv: line 4: time_s goes back from 60 to 30 s"));
    CHECK_THAT(refusal_of_series(head + "0,-1\n"),
               Contains("line 2: discharge_m3_s: -1 is out of range; allowed: >= 0 and <= 1000000 m3/s"));
    CHECK_THAT(refusal_of_series(head + "0,nan\n"), Contains("expected a number, found \"nan\""));
    CHECK_THAT(refusal_of_series(head + "0\n"), Contains("1 values; allowed: 2"));
    CHECK_THAT(refusal_of_series("time_s;discharge_m3_s\n0;1\n"), Contains("its columns stand between semicolons"));
    CHECK_THAT(refusal_of_series(head), Contains("there are no rows"));
    std::string wide = "time_s,discharge_m3_s";
    for (int column = 2; column < 1000; ++column) wide += ",c" + std::to_string(column);
    CHECK_THAT(refusal_of_series(wide + "\n"), Contains("there is no column \"c2\""));
    CHECK_THAT(refusal_of_series(wide + ",d\n"), Contains("line 1: it has more columns than 1000"));
}

TEST_CASE("columns of tables have the names and units that are read, in any order") {
    const auto unknown = [](const std::string& column) {
        return "q.csv: line 1: there is no column \"" + column + "\"";
    };
    const std::string allowed =
        "; allowed: time_s [s], discharge_m3_s [m3/s]. Remedy: bring the values into these units";
    for (const std::string name :
         {"q", "feet", "ft", "level_m", "discharge", "cfs", "m3/h", "discharge_l_s", "discharge_cfs", "discharge_m3_h",
          "discharge_m3_s [cfs]", "Discharge_m3_s", "value", "2"})
        CHECK_THAT(refusal_of_series("time_s," + name + "\n0,1\n"), Contains(unknown(name) + allowed));
    for (const std::string name : {"time", "t", "time_min", "minutes", "hours", "time_h", "time_ms", "date", "Time_s"})
        CHECK_THAT(refusal_of_series(name + ",discharge_m3_s\n0,1\n"), Contains(unknown(name) + allowed));
    CHECK_THAT(refusal_of_series("time_s,discharge_m3_s,quality\n0,1,2\n"), Contains(unknown("quality") + allowed));
    for (const std::string first : {"0,1\n5,2\n", "-1.5,1e3\n"})
        CHECK_THAT(refusal_of_series(first),
                   Contains("q.csv: line 1: it has no names of columns; allowed: a first line of names, which tell the "
                            "units: time_s [s], discharge_m3_s [m3/s]"));
    CHECK_THAT(refusal_of_series("time_s\n0\n"), Contains("line 1: the column discharge_m3_s is missing"));
    CHECK(refusal_of_series("discharge_m3_s,time_s\n1,0\n2,60\n").empty());
    const wade::Series turned = wade::parse_series("discharge_m3_s,time_s\n1,0\n2,60\n", "q.csv", discharge);
    CHECK((turned[1].time == 60 && turned[1].value == 2));
    const auto refused = [](const std::string& text) {
        try {
            static_cast<void>(wade::parse_residents(text, "p.csv"));
        } catch (const wade::ConfigurationError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    for (const std::string name : {"height_ft", "height_m", "height_cm", "mass_lb", "weight", "feet", "leaves_at_min",
                                   "lon", "X", "age_years", "z"})
        CHECK_THAT(refused("x,y," + name + "\n1,2,3\n"),
                   Contains("p.csv: line 1: there is no column \"" + name + "\"; allowed: id, x [m], y [m]"));
    CHECK_THAT(refused("500100,6000200\n"), Contains("it has no names of columns"));
    CHECK(refused("y,age,x\n2,30,1\n").empty());
}

TEST_CASE("residents are read by the names of their columns, and what is wrong is named with its line") {
    const auto people = wade::parse_residents(
        "# "
        "who\r\nid,y,x,age,sex,height,mass,skill,group,leaves_at\r\na,2,1,40,male,1.8,80,good,walkers,12.5\r\nb,4,3,,,,"
        ",,,\r\n",
        "p.csv");
    REQUIRE(people.size() == 2);
    const wade::Resident& one = people[0];
    CHECK((one.id == "a" && one.x == 1 && one.z == 2 && one.group == "walkers" && one.leaves_at == 12.5));
    CHECK((one.person.age == 40. && one.person.height == 1.8 && one.person.mass == 80.));
    CHECK((one.person.sex == wade::SexRule::male && one.person.skill == wade::Skill::good));
    CHECK((people[1].group.empty() && !people[1].person.height && !people[1].leaves_at));
    const auto refused = [](const std::string& text) {
        try {
            (void)wade::parse_residents(text, "p.csv");
        } catch (const wade::ConfigurationError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK_THAT(refused("id,x\n"), Contains("p.csv: line 1: the column y is missing; allowed: id, x [m], y [m]"));
    CHECK_THAT(refused("x,y,name\n"),
               Contains("there is no column \"name\"; allowed: id, x [m], y [m], age [years], sex"));
    CHECK_THAT(refused("x,y\n1\n"), Contains("line 2: 1 values; allowed: 2"));
    CHECK_THAT(refused("x,y,age\n1,2,two\n"), Contains("line 2: age: expected a number, found \"two\" (string)") &&
                                                  Contains("allowed: >= 3 and <= 110"));
    CHECK_THAT(refused("x,y,sex\n1,2,f\n"),
               Contains("sex: \"f\" is not allowed; allowed: \"any\", \"female\", \"male\""));
    CHECK_THAT(refused("id,x,y\na,1,2\na,1,2\n"), Contains("line 3: id \"a\" stands twice"));
    CHECK_THAT(refused("x,y\n"), Contains("there are no people"));
}

TEST_CASE("damaged shapes and series are read or refused, never a crash") {
    const std::string table = "time_s,discharge_m3_s\n0,1.5\n60,2\n";
    std::size_t refused = 0;
    const std::size_t tries = 4000;
    for (std::size_t i = 0; i < tries; ++i) {
        std::string text = i % 2 == 0 ? two_houses : table;
        for (std::size_t k = 0; k < 1 + i % 3; ++k) {
            const std::uint64_t bits = shape_bits(i * 100 + k);
            text[bits % text.size()] = static_cast<char>(bits >> 40);
        }
        if (i % 5 == 0) text.resize(shape_bits(i + 1) % text.size());
        refused += (i % 2 == 0 ? refusal_of_shapes(text) : refusal_of_series(text)).empty() ? 0U : 1U;
    }
    CHECK(refused > tries / 5);
}
