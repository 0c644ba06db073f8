// Tables and properties of others: one reader, and the types, limits and messages of the keys in a scene.

#include <catch2/catch.hpp>

#include "configs/errors/exit_code.hpp"
#include "configs/files/csv_table.hpp"
#include "configs/files/geojson.hpp"
#include "configs/files/residents_csv.hpp"
#include "configs/files/text_file.hpp"
#include "configs/json/json.hpp"
#include "scene_texts.hpp"

namespace wade::table_test {

template <typename Read>
std::string refusal_by(const Read& read) {
    try {
        static_cast<void>(read());
    } catch (const ConfigurationError& error) {
        return error.what();
    }
    return "";
}

std::string refusal_of_table(const std::string& text) {
    return refusal_by([&] {
        CsvTable table(text, "t.csv");
        while (table.next()) {
        }
        return table.line();
    });
}

std::string refusal_of_map(const std::string& text) {
    return refusal_by([&] { return parse_geojson(text, "m.geojson"); });
}

std::string square(double x, double z, double size) {
    const auto point = [](double a, double b) { return "[" + std::to_string(a) + "," + std::to_string(b) + "]"; };
    return "[" + point(x, z) + "," + point(x + size, z) + "," + point(x + size, z + size) + "," + point(x, z + size) +
           "," + point(x, z) + "]";
}
std::string map_of(const std::string& type, const std::string& coordinates, const std::string& properties = "{}",
                   const std::string& more = "") {
    return R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": )" + properties +
           R"(, "geometry": {"type": ")" + type + R"(", "coordinates": )" + coordinates + "}}]" + more + "}";
}

// A site of 20 m x 10 m at (500100, 6000200) with the files; the refusal of its scene, empty for none.
std::string refusal_of_site(const std::string& keys, const std::string& file, const std::string& text,
                            const std::string& ground = R"("ground": {"level_m": 10})") {
    const test::TemporaryFolder folder;
    folder.write(file, text);
    const auto scene = folder.write(
        "scene.json", R"({"world": {"length_m": 20, "width_m": 10}, "site": {"epsg": 32756, "origin_easting_m": 500100,
                "origin_northing_m": 6000200, )" +
                          ground + ", " + keys + "}}");
    return refusal_by([&] { return load_scene(scene); });
}
std::string refusal_of_house(const std::string& properties) {
    return refusal_of_site(R"("houses": [{"file": "h.geojson"}])", "h.geojson",
                           map_of("Polygon", "[" + square(500102, 6000202, 4) + "]", properties));
}

}  // namespace wade::table_test

using namespace wade::table_test;
using Catch::Matchers::Contains;

TEST_CASE("a table has quoted cells, any line ends, comments and a byte order mark of its file") {
    const std::string text = "# note\nname , x,y\r\n\"Muster, A\",1, 2 \r\r\n\"said \"\"no\"\"\n#1\",,4\n\n";
    wade::CsvTable table(text, "t.csv");
    CHECK(table.columns() == std::vector<std::string>{"name", "x", "y"});
    REQUIRE(table.next());
    CHECK((table.cell(0) == "Muster, A" && table.cell(1) == "1" && table.cell(2) == "2" && table.line() == 3));
    REQUIRE(table.next());
    CHECK((table.cell(0) == "said \"no\"\n#1" && table.cell(1).empty() && table.cell(2) == "4" && table.line() == 5));
    CHECK_FALSE(table.next());
    const wade::test::TemporaryFolder folder;
    CHECK(wade::read_residents(folder.write("r.csv", "\xEF\xBB\xBFid,x,y\n\"Muster, A\",25,25\n"))[0].id ==
          "Muster, A");
}

TEST_CASE("what is no table of commas is named with its line and the remedy") {
    CHECK_THAT(refusal_of_table("a;b\n1;2\n"), Contains("t.csv: line 1: its columns stand between semicolons"));
    CHECK_THAT(refusal_of_table("a\tb\n"), Contains("between tabs"));
    CHECK_THAT(refusal_of_table("a,b,a\n"), Contains("the column \"a\" stands twice"));
    CHECK_THAT(refusal_of_table("a,b\n1,2\n12,5,3\n"), Contains("line 3: 3 values; allowed: 2"));
    CHECK_THAT(refusal_of_table("a,b\n1,\"2\n"), Contains("line 2: a quote is not closed"));
    CHECK_THAT(refusal_of_table("a,b\n1,\"2\"3\n"), Contains("text after a quote"));
    CHECK_THAT(refusal_of_table("a,b\n1,2\"3\n"), Contains("a quote stands within the cell"));
    CHECK_THAT(refusal_of_table(std::string("a\0,\0b\0\n\0", 8)), Contains("no text in UTF-8"));
    for (const std::string text : {"\xFF\xFE", "a\n\xE9t\xE9\n", "a\n\xC3\n", "a\n\xC0\x80\n", "a\n\xED\xA0\x80\n"}) {
        CHECK_THAT(refusal_of_table(text), Contains("no text in UTF-8"));
    }
    CHECK(wade::is_utf8("\xC3\xA9t\xC3\xA9 \xE2\x82\xAC \xF0\x9F\x8C\x8A"));
    std::string rows = "a\n";
    for (std::size_t i = 0; i <= wade::CsvTable::max_rows; ++i) rows += "1\n";
    CHECK_THAT(refusal_of_table(rows), Contains("more rows than 500000"));
}

TEST_CASE("a resident needs a position; other empty cells set nothing") {
    const auto refused = [](const std::string& text) {
        return refusal_by([&] { return wade::parse_residents(text, "r.csv"); });
    };
    CHECK_THAT(refused("id,x,y,age\na,25,25,\nb,,,30\n"), Contains("r.csv: line 3: x is empty"));
    CHECK_THAT(refused("x,y\n1,\n"), Contains("line 2: y is empty"));
    CHECK(refused("id,x,y,age\na,25,25,\n").empty());
    CHECK_THAT(refused("x,y,height\n1,2,39'\n"), Contains("height: expected a number, found \"39'\""));
    CHECK_THAT(refused("x,y,height\n1,2,12\n"), Contains("height: 12 is out of range; allowed: >= 0.5"));
    CHECK_THAT(refused("x,y,mass\n1,2,1e300\n"), Contains("mass: 1e+300 is out of range"));
    CHECK_THAT(refused("x,y,leaves_at\n1,2,-9999\n"), Contains("leaves_at: -9999 is out of range"));
    CHECK_THAT(refused("x,y,group\n1,2,a b\n"), Contains("group: \"a b\" is not allowed"));
    CHECK_THAT(refused("x,y\n1e10,2\n"), Contains("x: 10000000000 is out of range"));
}

TEST_CASE("values of series have the limits of the inline key, and levels those of the ground") {
    const auto stage = [](const std::string& value) {
        return refusal_of_site(R"("outlets": [{"line": [[0, 0], [0, 10]], "kind": "stage", "stage_csv": "s.csv"}])",
                               "s.csv", "time_s,level_m\n0,11\n60," + value + "\n");
    };
    for (const std::string value : {"1e300", "-9998", "-998", "-99.5", "111", "1e7"})
        CHECK_THAT(stage(value), Contains("s.csv: line 3: level_m: ") && Contains("allowed: >= -90 and <= 110 m"));
    for (const std::string value : {"-9999", "-999", "-99.9"})
        CHECK_THAT(stage(value), Contains("line 3: level_m is " + value + ", a mark of missing data"));
    CHECK_THAT(stage(""), Contains("line 3: level_m is empty"));
    CHECK_THAT(stage("11,5"), Contains("line 3: 3 values"));
    CHECK_THAT(stage("nan"), Contains("expected a number, found \"nan\""));
    CHECK(stage("-5").empty());
    const auto discharge = [](const std::string& value) {
        return refusal_of_site(R"("sources": [{"line": [[0, 0], [0, 10]], "hydrograph_csv": "q.csv"}])", "q.csv",
                               "time_s,discharge_m3_s\n0,1\n60," + value + "\n");
    };
    for (const std::string value : {"1e300", "-9998", "-1", "2e6"})
        CHECK_THAT(discharge(value), Contains("q.csv: line 3: discharge_m3_s: ") && Contains("out of range"));
    const auto rain = [](const std::string& value) {
        return refusal_of_site(R"("rain": {"rate_csv": "r.csv"})", "r.csv", "time_s,rate_mm_h\n0," + value + "\n");
    };
    CHECK_THAT(rain("1e300"), Contains("r.csv: line 2: rate_mm_h: ") && Contains("<= 2000 mm/h"));
    CHECK_THAT(rain("-9999"), Contains("mark of missing data"));
    const auto inline_level = [](const std::string& value) {
        return refusal_of_site(R"("outlets": [{"line": [[0, 0], [0, 10]], "kind": "stage", "level_m": )" + value + "}]",
                               "n", "");
    };
    CHECK_THAT(inline_level("-99.5"), Contains("allowed: >= -90 and <= 110 m"));
    CHECK(inline_level("11").empty());
}

TEST_CASE("properties have the types and limits of their keys") {
    CHECK_THAT(refusal_of_house(R"({"residents": true})"),
               Contains("residents: expected a whole number, found true (boolean)"));
    CHECK_THAT(refusal_of_house(R"({"residents": "3"})"), Contains("found \"3\" (string). Remedy: the number alone"));
    CHECK_THAT(refusal_of_house(R"({"residents": 3.7})"), Contains("expected a whole number, found 3.7"));
    CHECK_THAT(refusal_of_house(R"({"residents": 100001})"), Contains("residents: 100001 is out of range"));
    CHECK_THAT(refusal_of_house(R"({"doors": "south"})"), Contains("doors: expected an array of points"));
    CHECK_THAT(refusal_of_house(R"({"doors": [["a", 2]]})"), Contains("is no point"));
    CHECK_THAT(refusal_of_house(R"({"name": 7})"), Contains("name: expected a string, found 7"));
    for (const std::string height : {"\"39'\"", "\"39 ft\"", "\"12,5\"", "\"12m\"", "\"12 m\"", "[3]", "true"})
        CHECK_THAT(refusal_of_house(R"({"height_m": )" + height + "}"), Contains("height_m: expected a number, found"));
    CHECK_THAT(refusal_of_house(R"({"height_m": -5})"),
               Contains("height_m: -5 is out of range; allowed: > 0 and <= 1000 m"));
    CHECK_THAT(refusal_of_house(R"({"upper_floor_m": 0})"), Contains("upper_floor_m: 0 is out of range"));
    CHECK(refusal_of_house(R"({"residents": 3.0, "height_m": 12.5, "upper_floor_m": null, "other": [true]})").empty());
    for (const std::string other : {"height", "Height", "building:levels", "LEVELS"})
        CHECK_THAT(refusal_of_house(R"({")" + other + R"(": "39'"})"),
                   Contains("and no height_m") && Contains("site import"));
    CHECK_THAT(refusal_of_house(R"({"building": "no"})"), Contains("it has \"building\""));
    CHECK(refusal_of_house(R"({"height": "39'", "height_m": 11.9})").empty());
    const auto of = [](const std::string& keys, const std::string& properties) {
        return refusal_of_site(keys, "h.geojson",
                               map_of("Polygon", "[" + square(500102, 6000202, 4) + "]", properties));
    };
    CHECK_THAT(of(R"("shelters": [{"file": "h.geojson"}])", R"({"capacity": "many"})"), Contains("capacity: expected"));
    CHECK_THAT(of(R"("manning": {"zones": [{"file": "h.geojson"}]})", R"({"n": 30})"),
               Contains("n: 30 is out of range"));
    CHECK_THAT(of(R"("water": [{"file": "h.geojson", "level_m": 10}])", R"({"level_m": -999})"),
               Contains("level_m: -999"));
    CHECK_THAT(of(R"("sources": [{"file": "h.geojson"}])", R"({"discharge_m3_s": -1})"),
               Contains("discharge_m3_s: -1"));
}

TEST_CASE("systems of GeoJSON are read or refused in all their spellings") {
    const auto system_of = [](const std::string& member) {
        return wade::parse_geojson(map_of("Polygon", "[" + square(1e5, 2e5, 4) + "]", "{}", ", " + member), "m.geojson")
            .epsg;
    };
    const auto named = [](const std::string& name) {
        return R"("crs": {"type": "name", "properties": {"name": ")" + name + "\"}}";
    };
    for (const std::string name :
         {"urn:ogc:def:crs:EPSG::2056", "urn:ogc:def:crs:EPSG:9.9:2056", "EPSG:2056", "epsg:2056",
          "http://www.opengis.net/def/crs/EPSG/0/2056", "https://www.opengis.net/def/crs/EPSG/0/2056"})
        CHECK(system_of(named(name)) == 2056);
    CHECK(system_of(R"("crs": {"type": "EPSG", "properties": {"code": 2056}})") == 2056);
    CHECK(system_of(R"("coordRefSys": "http://www.opengis.net/def/crs/EPSG/0/2056")") == 2056);
    CHECK_FALSE(system_of(R"("crs": null)"));
    const auto refused = [](const std::string& member) {
        return refusal_of_map(map_of("Polygon", "[" + square(1e5, 2e5, 4) + "]", "{}", ", " + member));
    };
    CHECK_THAT(refused(R"("crs": {"type": "EPSG", "properties": {"code": 4326}})"),
               Contains("EPSG:4326 counts in degrees"));
    CHECK_THAT(refused(R"("crs": {"type": "EPSG", "properties": {"code": 2263}})"),
               Contains("no projected system in metres"));
    CHECK_THAT(refused(R"("crs": {"type": "link", "properties": {"href": "a.prj"}})"), Contains("no EPSG number"));
    CHECK_THAT(refused(R"("crs": 32632)"), Contains("no EPSG number"));
    CHECK_THAT(refused(named("urn:ogc:def:crs:EPSG::32632+5773")), Contains("no EPSG number"));
    CHECK_THAT(refused(named("ESRI:102003")), Contains("no EPSG number"));
    CHECK_THAT(refused(R"("coordRefSys": ["http://www.opengis.net/def/crs/EPSG/0/2056"])"), Contains("no EPSG number"));
    CHECK_THAT(refused(R"("crs": {"type": "EPSG", "properties": {"code": 2056}}, "coordRefSys": "EPSG:32632")"),
               Contains("allowed: one system"));
    CHECK_THAT(refusal_of_site(R"("houses": [{"file": "h.geojson"}])", "h.geojson",
                               map_of("Polygon", "[" + square(500102, 6000202, 4) + "]", "{}",
                                      ", " + named("http://www.opengis.net/def/crs/EPSG/0/2056"))),
               Contains("it is in EPSG:2056, and the site is in EPSG:32756"));
}

TEST_CASE("keys that stand twice, holes outside, parts on one another and too many values are refused") {
    CHECK_THAT(
        refusal_of_map(map_of("Polygon", "[" + square(1000, 0, 4) + "]", R"({"residents": 3, "residents": 30})")),
        Contains("m.geojson: the key \"residents\" stands twice"));
    const std::string outline = square(1000, 0, 40), hole = square(1010, 10, 5), far = square(1050, 50, 5);
    CHECK(refusal_of_map(map_of("Polygon", "[" + outline + "," + hole + "]")).empty());
    CHECK_THAT(refusal_of_map(map_of("Polygon", "[" + outline + "," + far + "]")),
               Contains("a hole lies outside of its outline"));
    CHECK(refusal_of_map(map_of("MultiPolygon", "[[" + outline + "],[" + far + "]]")).empty());
    CHECK_THAT(refusal_of_map(map_of("MultiPolygon", "[[" + outline + "],[" + hole + "]]")),
               Contains("its parts 0 and 1 lie on"));
    CHECK_THAT(refusal_of_map(map_of("MultiPolygon", "[[" + hole + "],[" + outline + "]]")),
               Contains("its parts 0 and 1 lie on"));
    CHECK(
        refusal_of_map(map_of("MultiPolygon", "[[" + square(1000, 0, 4) + "],[" + square(1004, 0, 4) + "]]")).empty());
    std::string zeros = "[";
    for (int i = 0; i < 2'000'001; ++i) zeros += "0,";
    CHECK_THAT(refusal_of_map(zeros + "0]"), Contains("more values than coordinates"));
}

TEST_CASE("one MultiPolygon is one house: its residents count once") {
    const wade::test::TemporaryFolder folder;
    folder.write("h.geojson", map_of("MultiPolygon",
                                     "[[" + square(500102, 6000202, 2) + "],[" + square(500105, 6000202, 2) + "],[" +
                                         square(500108, 6000202, 2) + "]]",
                                     R"({"residents": 10})"));
    const auto scene = folder.write(
        "scene.json", R"({"world": {"length_m": 20, "width_m": 10}, "site": {"epsg": 32756, "origin_easting_m": 500100,
                "origin_northing_m": 6000200, "ground": {"level_m": 10}, "houses": [{"file": "h.geojson"}]}})");
    const wade::Scene loaded = wade::load_scene(scene).scene;
    REQUIRE(loaded.site->houses.size() == 1);
    CHECK((loaded.site->houses[0].residents == 10 && loaded.site->houses[0].polygon.rings.size() == 3));
}

TEST_CASE("shapes with a corner far off are refused before any work is done on them, as are houses that stand twice") {
    const std::string far = "[[2, 2], [6, 2], [999000, 8]]";
    const auto refused = [](const std::string& keys) { return refusal_of_site(keys, "n", ""); };
    CHECK_THAT(refused(R"("houses": [{"polygon": )" + far + "}]"),
               Contains("/site/houses/0: its corner at x 999000 m"));
    CHECK_THAT(refused(R"("outlets": [{"polygon": )" + far + "}]"), Contains("/site/outlets/0: its corner"));
    CHECK_THAT(refused(R"("outlets": [{"line": )" + far + "}]"), Contains("/site/outlets/0: its corner"));
    CHECK_THAT(refused(R"("gates": [{"line": )" + far + "}]"), Contains("/site/gates/0: its corner"));
    CHECK_THAT(refused(R"("shelters": [{"polygon": )" + far + "}]"), Contains("/site/shelters/0: its corner"));
    CHECK_THAT(refused(R"("water": [{"level_m": 11, "polygon": )" + far + "}]"), Contains("/site/water/0: its corner"));
    CHECK_THAT(refused(R"("sources": [{"discharge_m3_s": 1, "line": )" + far + "}]"),
               Contains("/site/sources/0: its corner"));
    CHECK_THAT(refused(R"("manning": {"zones": [{"polygon": )" + far + "}]}"),
               Contains("/site/manning/zones/0: its corner"));
    const std::string lake = "[[-5000, -3000], [9000, -3000], [9000, 3000], [-5000, 3000]]";
    CHECK(refused(R"("water": [{"level_m": 11, "polygon": )" + lake + "}]").empty());
    const std::string hut = R"({"polygon": [[2, 2], [6, 2], [6, 6], [2, 6]], "residents": 3})";
    CHECK_THAT(refused(R"("houses": [)" + hut + "," + hut + "]"),
               Contains("/site/houses/1: it is the same house as /site/houses/0"));
    const std::string turned = R"({"polygon": [[6, 6], [2, 6], [2, 2], [6.01, 2]], "residents": 3})";
    CHECK_THAT(refused(R"("houses": [)" + hut + "," + turned + "]"), Contains("the same house"));
}

TEST_CASE("people of a table at one position are refused") {
    std::string rows = "x,y\n";
    for (int i = 0; i < 11; ++i) rows += "500103,6000203\n";
    const std::string keys = R"("residents_csv": "r.csv")";
    CHECK_THAT(refusal_of_site(keys, "r.csv", rows), Contains("line 12: 11 people stand on one square metre outdoors"));
    const std::string house = keys + R"(, "houses": [{"polygon": [[2, 2], [6, 2], [6, 6], [2, 6]]}])";
    CHECK_THAT(refusal_of_site(house, "r.csv", rows), !Contains("square metre"));
}

// 20 m x 10 m hold at most 994 bodies of radius 0.25 m, those at the edge half outside (densest packing).
TEST_CASE("more people outdoors than bodies find room in the world are refused before a crowd is made") {
    const auto refused = [](int count, const std::string& bodies) {
        const wade::test::TemporaryFolder folder;
        std::string rows = "x,y\n";
        for (int k = 0; k < count; ++k) {
            rows +=
                std::to_string(500100.2 + k % 50 * 0.4) + "," + std::to_string(6000200.2 + k / 50 % 25 * 0.4) + "\n";
        }
        folder.write("r.csv", rows);
        const auto scene =
            folder.write("scene.json", R"({"world": {"length_m": 20, "width_m": 10}, "site": {"epsg": 32756,
            "origin_easting_m": 500100, "origin_northing_m": 6000200, "ground": {"level_m": 10}, "residents_csv": "r.csv",
            "shelters": [{"polygon": [[2, 2], [6, 2], [6, 6]]}]}, "crowd": {"bodies": ")" +
                                           bodies + R"(",
            "groups": [{"name": "r", "start": {"from": "houses"}, "goal": {"to": "shelters"}}]}})");
        return refusal_by([&] { return wade::load_scene(scene); });
    };
    CHECK_THAT(refused(1000, "human"),
               Contains("/site/residents_csv: 1000 people are outdoors; allowed: <= 994, as bodies "
                        "of radius 0.25 m (/crowd/body_radius_m) fill the world"));
    CHECK(refused(990, "human").empty());
    CHECK(refused(1000, "none").empty());
}
