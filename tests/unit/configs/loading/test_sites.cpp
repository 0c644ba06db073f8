// Scenes on a site: what keys and files say becomes plain data, and what is wrong is named with key, file and remedy.

#include <catch2/catch.hpp>
#include <cmath>

#include "configs/json/json.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "scene_texts.hpp"

namespace wade::site_test {

const std::string grid = "ncols 10\nnrows 5\nxllcorner 500100\nyllcorner 6000200\ncellsize 2\n" + [] {
    std::string values;
    for (int row = 5; row-- > 0;) {
        for (int column = 0; column < 10; ++column) values += std::to_string(10 + 0.1 * row + 0.01 * column) + " ";
        values += "\n";
    }
    return values;
}();

const std::string houses = R"({"type": "FeatureCollection", "features": [
  {"type": "Feature", "properties": {"name": "mill", "residents": 3, "height_m": 4, "n": 0.02, "capacity": 5},
   "geometry": {"type": "Polygon", "coordinates": [[[500102, 6000202], [500104, 6000202], [500104, 6000204]]]}},
  {"type": "Feature", "properties": {},
   "geometry": {"type": "Polygon", "coordinates": [[[500110, 6000202], [500112, 6000202], [500112, 6000206]]]}}]})";

// A folder with these files, the scene in it.
class Folder {
 public:
    Folder() {
        folder.write("ground.asc", grid);
        folder.write("houses.geojson", houses);
        folder.write("q.csv", "time_s,discharge_m3_s\n0,0\n60,2\n");
    }
    [[nodiscard]] std::filesystem::path scene(const std::string& site, const std::string& more = "") const {
        return folder.write("scene.json", R"({"site": )" + site + more + "}");
    }
    [[nodiscard]] std::string refused(const std::string& site, const std::string& more = "") const {
        return test::refusal_of_file(scene(site, more));
    }
    test::TemporaryFolder folder;
};

const std::string ground = R"({"epsg": 32756, "ground": {"file": "ground.asc"})";

}  // namespace wade::site_test

using wade::Json;
using namespace wade::site_test;
using Catch::Matchers::Contains;

TEST_CASE("/place is /site until version 1.0, beside any number of keys and in what is set") {
    const Folder folder;
    const std::vector<std::string> keys{R"("name": "a")",
                                        R"("seed": 3)",
                                        R"("duration_s": 5)",
                                        R"("frame_rate_hz": 4)",
                                        R"("lockstep_depth": 1)",
                                        R"("description": "b")",
                                        R"("world": {"gravity_m_s2": 9})",
                                        R"("fluid": {"cfl": 0.4})"};
    std::string before, after;
    for (const std::string& key : keys) {
        const auto hash = [&](const std::string& name) {
            return wade::load_scene(folder.folder.write(
                                        "scene.json", "{" + before + "\"" + name + "\": " + ground + "}" + after + "}"))
                .scene.hash;
        };
        INFO(before << " ... " << after);
        CHECK(hash("place") == hash("site"));
        (before.size() < after.size() ? before : after) += before.size() < after.size() ? key + ", " : ", " + key;
    }
    const auto scene = folder.scene(ground + "}");
    const auto with = [&](const std::string& pointer) {
        return wade::load_scene(scene, {wade::parse_override(pointer + "/manning/n=0.09")}).scene.hash;
    };
    CHECK(with("/place") == with("/site"));
}

TEST_CASE("a site without all else: its raster is the world, and the water is shallow water") {
    const Folder folder;
    const wade::Scene scene = wade::load_scene(folder.scene(ground + "}")).scene;
    REQUIRE(scene.site);
    CHECK((scene.world->length == 20 && scene.world->width == 10));
    CHECK((scene.channel->x.hi == 20 && scene.channel->z.hi == 10 && scene.channel->flow == wade::Flow::closed));
    CHECK(scene.fluid->model == wade::ModelKind::shallow_water);
    CHECK((scene.site->epsg == 32756 && scene.site->origin_x == 500100 && scene.site->origin_z == 6000200));
    const wade::Raster& raster = *scene.site->ground.raster;
    CHECK((raster.x == 0 && raster.z == 0 && raster.at(3, 2) == 10.23));
}

TEST_CASE("ways of a large site have a million cells unless the scene says how large they are") {
    const auto cell_of = [](const std::string& more) {
        const Folder folder;
        const std::string level = R"({"ground": {"level_m": 0}})";
        return wade::load_scene(folder.scene(level, more)).scene.crowd->navigation.cell;
    };
    CHECK(cell_of(R"(, "world": {"length_m": 4000, "width_m": 1000})") == 2);
    CHECK(cell_of(R"(, "world": {"length_m": 400, "width_m": 300})") == 0.5);
    CHECK(cell_of(R"(, "world": {"length_m": 40000, "width_m": 10000},
                      "fluid": {"shallow_water": {"cell_size_m": 4}})") == 10);
    CHECK(cell_of(R"(, "world": {"length_m": 4000, "width_m": 1000}, "crowd": {"navigation": {"cell_m": 1}})") == 1);
}

TEST_CASE("houses, zones, sources and shelters of files are in the scene's metres; properties stand over keys") {
    const Folder folder;
    const wade::Scene scene =
        wade::load_scene(
            folder.scene(ground + R"(, "houses": [{"file": "houses.geojson", "residents": 2, "upper_floor_m": 3},
                                                 {"name": "hut", "polygon": [[15, 6], [17, 6], [17, 8]], "doors": [[16, 6]]}],
                "manning": {"n": 0.04, "zones": [{"file": "houses.geojson", "n": 0.1}]},
                "sources": [{"name": "creek", "line": [[0, 1], [0, 9]], "hydrograph_csv": "q.csv"}],
                "rain": {"rate_mm_h": 30},
                "outlets": [{"line": [[20, 4], [20, 10]]}, {"kind": "stage", "level_m": 9, "polygon": [[18, 0], [20, 0], [20, 3]]}],
                "gates": [{"line": [[5, 0], [5, 10]], "opens_at_s": 7}],
                "walls": [{"line": [[3, 3], [3, 6], [6, 6]], "crest_m": 99}],
                "water": [{"level_m": 10.2, "polygon": [[0, 0], [5, 0], [5, 10]]}],
                "shelters": [{"file": "houses.geojson", "capacity": 100}]})"))
            .scene;
    const wade::Site& site = *scene.site;
    REQUIRE(site.houses.size() == 3);
    const wade::House &mill = site.houses[0], &second = site.houses[1], &hut = site.houses[2];
    CHECK((mill.name == "mill" && mill.residents == 3 && mill.height == 4 && mill.upper_floor == 3));
    CHECK((mill.polygon.rings[0][1].x == 4 && mill.polygon.rings[0][1].z == 2));
    CHECK((second.residents == 2 && second.height == 6));
    CHECK((hut.name == "hut" && hut.residents == 0 && std::isnan(hut.upper_floor) && hut.doors[0].x == 16));
    REQUIRE(site.roughness.zones.size() == 2);
    CHECK((site.roughness.n == 0.04 && site.roughness.zones[0].n == 0.02 && site.roughness.zones[1].n == 0.1));
    CHECK(
        (site.sources[0].name == "creek" && site.sources[0].discharge[1].value == 2 && site.sources[0].line[1].z == 9));
    CHECK(site.rain[0].value == 30);
    CHECK((site.outlets[0].kind == wade::OutletKind::free && site.outlets[1].stage[0].value == 9));
    REQUIRE(site.barriers.size() == 2);
    CHECK((site.barriers[1].crest == 99 && !std::isfinite(site.barriers[1].opens_at)));
    REQUIRE(site.barriers[1].plan.rings.size() == 1);
    CHECK((contains(site.barriers[1].plan, {3.05, 5}) && contains(site.barriers[1].plan, {2.95, 6.05})));
    CHECK_FALSE(contains(site.barriers[1].plan, {3.5, 5}));
    CHECK((site.barriers[0].opens_at == 7 && site.water[0].level == 10.2));
    CHECK((site.shelters[0].capacity == 5 && site.shelters[1].capacity == 100));
}

TEST_CASE("gauges are points of the scene or of a file, with a name of their own") {
    const Folder folder;
    folder.folder.write("points.geojson", "\xEF\xBB\xBF" + std::string(R"({"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": {"name": "mill"}, "geometry": {"type": "Point", "coordinates": [500103, 6000202]}},
        {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [500104, 6000203]}}]})"));
    const std::string keys = R"(, "gauges": [{"name": "bridge", "x_m": 3, "z_m": 4}, {"file": "points.geojson"}])";
    const wade::Scene scene = wade::load_scene(folder.scene(ground + keys + "}")).scene;
    const std::vector<wade::Gauge>& gauges = scene.site->gauges;
    REQUIRE(gauges.size() == 3);
    CHECK((gauges[0].name == "bridge" && gauges[0].at.x == 3 && gauges[0].at.z == 4));
    CHECK((gauges[1].name == "mill" && gauges[1].at.x == 3 && gauges[1].at.z == 2 && gauges[2].name == "3"));
    const auto refused = [&](const std::string& more) { return folder.refused(ground + ", " + more + "}"); };
    CHECK_THAT(refused(R"("gauges": [{"x_m": 3}])"), Contains("/site/gauges/0: allowed: both x_m and z_m, or file"));
    CHECK_THAT(refused(R"("gauges": [{"file": "houses.geojson"}])"), Contains("feature 0 (mill): allowed: points"));
    CHECK_THAT(refused(R"("gates": [{"file": "points.geojson"}])"), Contains("it is a point; allowed: lines"));
    CHECK_THAT(refused(R"("gauges": [{"x_m": 3, "z_m": 44}])"), Contains("/site/gauges/0: it lies outside the site"));
    CHECK_THAT(
        refused(R"("gauges": [{"x_m": 3, "z_m": 3}], "houses": [{"polygon": [[2, 2], [4, 2], [4, 4], [2, 4]]}])"),
        Contains("1 at x 3 m, z 3 m is in the house /site/houses/0"));
    CHECK_THAT(refused(R"("gauges": [{"name": "a", "x_m": 3, "z_m": 3}, {"name": "a", "x_m": 4, "z_m": 3}])"),
               Contains("a is the name of another gauge, too"));
}

TEST_CASE("water and zones outside the site, or that cross themselves, are refused as houses are") {
    const Folder folder;
    const auto refused = [&](const std::string& more) { return folder.refused(ground + ", " + more + "}"); };
    CHECK_THAT(refused(R"("water": [{"polygon": [[90, 0], [95, 0], [95, 5]], "level_m": 11}])"),
               Contains("/site/water/0: it lies outside the site"));
    CHECK_THAT(refused(R"("water": [{"polygon": [[0, 0], [5, 5], [5, 0], [0, 4]], "level_m": 11}])"),
               Contains("/site/water/0: its outline crosses or touches itself"));
    CHECK_THAT(refused(R"("manning": {"zones": [{"polygon": [[90, 0], [95, 0], [95, 5]], "n": 0.1}]})"),
               Contains("/site/manning/zones/0: it lies outside the site"));
}

TEST_CASE("paths are relative to the file that names them, also in a scene that is extended and one that is printed") {
    const Folder folder;
    folder.folder.write("site/ground.asc", grid);
    folder.folder.write("site/base.json", R"({"site": {"epsg": 32756, "ground": {"file": "ground.asc"}}})");
    const auto scene = folder.folder.write("scenes/own.json", R"({"extends": "../site/base.json", "name": "own"})");
    const wade::LoadedScene loaded = wade::load_scene(scene);
    const auto printed = folder.folder.write("elsewhere/printed.json", loaded.canonical_json);
    const wade::LoadedScene again = wade::load_scene(printed);
    CHECK(again.scene.hash == loaded.scene.hash);
    CHECK(again.canonical_json == loaded.canonical_json);
    const Json resolved = Json::parse(loaded.canonical_json);
    CHECK(resolved["channel"]["x_max_m"] == 20);
    CHECK((resolved["site"]["epsg"] == 32756 && resolved["site"]["origin_easting_m"] == 500100));
}

TEST_CASE("the hash of a scene knows the contents of its files, not where they lie") {
    const Folder one, other;
    const std::string site = ground + R"(, "houses": [{"file": "houses.geojson"}]})";
    const auto hash = wade::load_scene(one.scene(site)).scene.hash;
    CHECK(wade::load_scene(other.scene(site)).scene.hash == hash);
    std::string higher = grid;
    other.folder.write("ground.asc", higher.replace(higher.find("10.23"), 5, "10.24"));
    CHECK(wade::load_scene(other.scene(site)).scene.hash != hash);
}

TEST_CASE("a path of --set is relative to where the program runs") {
    const Folder folder;
    const auto file = folder.scene(ground + "}");
    const std::string other = folder.folder.write("other.asc", grid).string();
    const wade::Scene scene = wade::load_scene(file, {wade::parse_override("/site/ground/file=" + other)}).scene;
    CHECK(scene.site->ground.file == other);
}

TEST_CASE("a plane or points are a ground without files") {
    const std::string more = R"(, "world": {"length_m": 30, "width_m": 20})";
    const Folder folder;
    const wade::Scene plane =
        wade::load_scene(folder.scene(R"({"ground": {"level_m": 3, "slope_x": 0.1}})", more)).scene;
    CHECK((plane.site->ground.level == 3 && plane.site->ground.slope_x == 0.1 && plane.world->length == 30));
    const wade::Scene points =
        wade::load_scene(folder.scene(R"({"ground": {"points": [[0, 1, 0], [30, 2, 0], [0, 3, 20]]}})", more)).scene;
    CHECK(points.site->ground.points[2] == std::array<double, 3>{0, 3, 20});
}

TEST_CASE("what does not go together on a site is named with key, file and remedy") {
    const Folder folder;
    const auto refused = [&](const std::string& more) { return folder.refused(ground + ", " + more + "}"); };
    CHECK_THAT(folder.refused(R"({"ground": {"file": "ground.asc"}})"),
               Contains("/site/ground/file: ") && Contains("names no coordinate system. Remedy: set /site/epsg"));
    CHECK_THAT(folder.refused(R"({"epsg": 4326, "ground": {"file": "ground.asc"}})"),
               Contains("/site/epsg: EPSG:4326 counts in degrees") && Contains("wade site import FILE --epsg"));
    CHECK_THAT(folder.refused(R"({"epsg": 32756, "ground": {"file": "none.asc"}})"),
               Contains("/site/ground") && Contains("none.asc cannot be read"));
    CHECK_THAT(folder.refused(R"({"epsg": 32756, "ground": {"file": "ground.asc", "level_m": 2}})"),
               Contains("allowed: one of them"));
    CHECK_THAT(folder.refused(ground + "}", R"(, "channel": {"depth_m": 2})"),
               Contains("/channel: a site stands instead"));
    CHECK_THAT(refused(R"("houses": [{"polygon": [[0, 0], [1, 1]]}])"), Contains("/site/houses/0/polygon: 2 corners"));
    CHECK_THAT(refused(R"("houses": [{"name": "a"}])"),
               Contains("/site/houses/0: it has no place; allowed: one of polygon or file"));
    CHECK_THAT(refused(R"("houses": [{"polygon": [[0, 0], [1, 1, 2], [2, 0]]}])"),
               Contains("point 1: [1,1,2] is not a point"));
    CHECK_THAT(refused(R"("sources": [{"line": [[0, 0], [1, 1]]}])"),
               Contains("neither discharge_m3_s nor hydrograph_csv"));
    CHECK_THAT(refused(R"("outlets": [{"line": [[0, 0], [1, 1]], "level_m": 2}])"),
               Contains("no effect on a free outlet"));
    const std::string wall = R"("walls": [{"line": [[1, 1], [1, 2], [3, 2]])";
    CHECK_THAT(refused(wall + "}]"), Contains("/site/walls/0: crest_m is missing"));
    CHECK_THAT(refused(wall + R"(, "crest_m": -3}])"), Contains("below the ground at all of its points"));
    CHECK_THAT(refused(R"("walls": [{"file": "houses.geojson", "crest_m": 99}])"), Contains("allowed: lines"));
    CHECK_THAT(refused(R"("gates": [{"file": "houses.geojson"}])"),
               Contains("feature 0 (mill): it is a polygon; allowed: lines"));
    folder.folder.write("back.csv", "time_s,discharge_m3_s\n5,1\n4,1\n");
    CHECK_THAT(refused(R"("sources": [{"line": [[0, 0], [1, 1]], "hydrograph_csv": "back.csv"}])"),
               Contains("/site/sources/0: ") && Contains("back.csv: line 3: time_s goes back"));
    folder.folder.write("tide.csv", "time_s,level_m\n0,1\n60,-9999\n");
    for (const std::string kind : {"stage", "wave"}) {
        const std::string outlet = R"("outlets": [{"line": [[0, 0], [1, 1]], "kind": ")" + kind + R"(")";
        CHECK_THAT(
            refused(outlet + R"(, "stage_csv": "tide.csv"}])"),
            Contains("/site/outlets/0: ") && Contains("tide.csv: line 3: level_m is -9999") && Contains("(no data)"));
        CHECK_THAT(refused(outlet + "}]"), Contains("/site/outlets/0: neither level_m nor stage_csv is set"));
    }
    Json other = Json::parse(houses);
    other["crs"] = {{"type", "name"}, {"properties", {{"name", "EPSG:32755"}}}};
    folder.folder.write("other.geojson", other.dump());
    CHECK_THAT(refused(R"("houses": [{"file": "other.geojson"}])"),
               Contains("other.geojson: it is in EPSG:32755, and the site is in EPSG:32756"));
    other["features"][1]["properties"]["height_m"] = "tall";
    other.erase("crs");
    folder.folder.write("other.geojson", other.dump());
    CHECK_THAT(refused(R"("houses": [{"file": "other.geojson"}])"),
               Contains("feature 1: height_m: expected a number, found \"tall\" (string). Remedy: the number alone"));
}
