// Sites that cannot be flooded or walked on: each with key, file, feature and remedy.

#include "configs/checks/scene_checks.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "scene_texts.hpp"

namespace wade::refused_site_test {

using test::TemporaryFolder;

// 20 m x 10 m of 2 m cells; `centre` is the height of the cell at x 9 m, z 5 m, `corner` that of the last one.
std::string ground_raster(const std::string& centre = "10", const std::string& corner = "10") {
    std::string text = "ncols 10\nnrows 5\nxllcorner 500100\nyllcorner 6000200\ncellsize 2\n";
    for (int k = 0; k < 50; ++k) text += (k == 24 ? centre : k == 49 ? corner : "10") + " ";
    return text;
}

std::string load_or_refusal(const std::string& more, const std::string& raster = ground_raster(),
                            const std::string& beside = "") {
    const TemporaryFolder folder;
    folder.write("ground.asc", raster);
    folder.write("bow.geojson",
                 R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {"name": "bow"},
        "geometry": {"type": "Polygon", "coordinates": [[[500102, 6000202], [500106, 6000206], [500106, 6000202], [500102, 6000206]]]}}]})");
    folder.write("far.geojson",
                 R"({"type": "Polygon", "coordinates": [[[400102, 6000202], [400106, 6000206], [400106, 6000202]]]})");
    const auto scene = folder.write("scene.json", R"({"site": {"epsg": 32756, "ground": {"file": "ground.asc"})" +
                                                      (more.empty() ? "" : ", " + more) + "}" + beside + "}");
    try {
        static_cast<void>(load_scene(scene));
    } catch (const ConfigurationError& error) {
        return error.what();
    }
    return "";
}

const std::string hut = R"("houses": [{"name": "hut", "polygon": [[2, 2], [8, 2], [8, 8], [2, 8]]}])";

}  // namespace wade::refused_site_test

using namespace wade::refused_site_test;
using Catch::Matchers::Contains;

TEST_CASE("holes inside the ground are counted; those that reach its edge are the outside") {
    CHECK_THAT(load_or_refusal("", ground_raster("-9999")),
               Contains("/site/ground/file: ") && Contains("ground.asc: 1 cells inside have no height") &&
                   Contains("x 9 m, z 5 m") && Contains("wade site import --fill"));
    CHECK(load_or_refusal("", ground_raster("10", "-9999")).empty());
    CHECK_THAT(load_or_refusal("", ground_raster("-32768")),
               Contains("row 3 from the top, column 5 is -32768 m") && Contains("gdal_translate -a_nodata -32768"));
    CHECK(load_or_refusal("", ground_raster("-9999"), R"(, "world": {"length_m": 8})").empty());  // it lies beyond
}

TEST_CASE(
    "shapes of more corners than any building has, and lists longer than a scene needs, are refused before any work") {
    std::string corners = "[2, 2]", gates = R"({"line": [[2, 2], [2, 3]]})";
    for (int k = 1; k <= 10'000; ++k) corners += ", [" + std::to_string(2 + 1e-4 * k) + ", 3]";
    CHECK_THAT(load_or_refusal(R"("gates": [{"line": [)" + corners + "]}]"),
               Contains("/site/gates/0") && Contains("it has 10001 corners; allowed: <= 10000"));
    for (int k = 1; k <= 20'000; ++k) gates += R"(, {"line": [[2, 2], [2, 3]]})";
    CHECK_THAT(load_or_refusal(R"("gates": [)" + gates + "]"),
               Contains("/site/gates: 20001 entries; allowed: up to 20000"));
}

TEST_CASE("a world beyond its ground is refused") {
    CHECK_THAT(load_or_refusal("", ground_raster(), R"(, "world": {"length_m": 30})"),
               Contains("it covers x 0 to 20 m"));
    CHECK_THAT(load_or_refusal(R"("origin_easting_m": 500000)"), Contains("it covers x 100 to 120 m"));
}

TEST_CASE("houses that cross themselves, enclose nothing or lie elsewhere are refused, those that touch are not") {
    CHECK_THAT(load_or_refusal(R"("houses": [{"file": "bow.geojson"}])"),
               Contains("/site/houses/0: ") &&
                   Contains("bow.geojson: feature 0 (bow): its outline crosses itself or encloses no area") &&
                   Contains("ogr2ogr -makevalid"));
    CHECK_THAT(load_or_refusal(R"("houses": [{"polygon": [[2, 2], [4, 2], [6, 2]]}])"),
               Contains("/site/houses/0: its outline has a spike"));
    CHECK_THAT(load_or_refusal(R"("houses": [{"file": "far.geojson"}])"),
               Contains("far.geojson: feature 0: it lies outside the site"));
    CHECK_THAT(load_or_refusal(R"("houses": [{"polygon": [[2, 2], [6, 2], [6, 6]], "doors": [[2, 6]]}])"),
               Contains("its door at x 2 m, z 6 m is 2.82843 m away"));
    CHECK(
        load_or_refusal(
            R"("houses": [{"polygon": [[2, 2], [4, 2], [4, 4], [2, 4]]}, {"polygon": [[4, 2], [6, 2], [6, 4], [4, 4]]},
                                        {"polygon": [[3, 3], [5, 3], [5, 5]]}])")
            .empty());
}

TEST_CASE(
    "polygons whose houses would vanish where they lie on one another are refused, islands and courtyards are not") {
    const auto point = [](int x, int z) {
        return "[" + std::to_string(500100 + x) + ", " + std::to_string(6000200 + z) + "], ";
    };
    const auto square = [&](int x, int z, int side, int turns = 1) {
        std::string ring;
        for (int turn = 0; turn < turns; ++turn)
            ring += point(x, z) + point(x + side, z) + point(x + side, z + side) + point(x, z + side);
        return "[" + ring.substr(0, ring.size() - 2) + "]";
    };
    const wade::test::TemporaryFolder folder;
    const auto refused = [&](const std::string& type, const std::string& coordinates) {
        const auto file =
            folder.write("h.geojson", R"({"type": ")" + type + R"(", "coordinates": [)" + coordinates + "]}");
        return load_or_refusal(R"("houses": [{"file": ")" + file.string() + R"("}])");
    };
    const std::string one = square(2, 2, 4), beside = square(4, 2, 4), inner = square(3, 3, 2);
    const auto parts = [](const std::string& a, const std::string& b) { return "[" + a + "], [" + b + "]"; };
    for (const std::string& polygon :
         {one + ", " + one, one + ", " + beside, square(2, 2, 4, 2), one + ", " + inner + ", " + inner,
          square(1, 1, 8) + ", " + one + ", " + beside, square(1, 1, 8) + ", " + one + ", " + inner,
          one + ", " + square(12, 2, 2), "[" + point(2, 2) + point(9, 2) + square(6, 2, 4).substr(1)}) {
        INFO(polygon);
        CHECK_THAT(refused("Polygon", polygon), Contains("h.geojson: feature 0: ") && Contains("ogr2ogr -makevalid"));
    }
    for (const std::string& two : {parts(one, one), parts(one, beside), parts(one, inner), parts(inner, one)}) {
        INFO(two);
        CHECK_THAT(refused("MultiPolygon", two), Contains("h.geojson: feature 0: ") && Contains("ogr2ogr -makevalid"));
    }
    CHECK(refused("Polygon", one + ", " + inner) == "");
    CHECK(refused("MultiPolygon", parts(square(1, 1, 8) + ", " + one, inner)) == "");
    CHECK(refused("MultiPolygon", parts(one, square(6, 6, 2))) == "");
    CHECK(refused("MultiPolygon", parts(one, square(6, 2, 4))) == "");
}

TEST_CASE("sources on roofs or outside are refused, those that reach the ground are not") {
    const auto refused = [](const std::string& source) {
        return load_or_refusal(hut + R"(, "sources": [{"discharge_m3_s": 1, )" + source + "}]");
    };
    CHECK_THAT(refused(R"("polygon": [[3, 3], [5, 3], [5, 5]])"),
               Contains("/site/sources/0: all of it lies on a roof, that of /site/houses/0. Remedy"));
    CHECK_THAT(refused(R"("line": [[3, 3], [5, 5]])"), Contains("on a roof"));
    CHECK_THAT(refused(R"("line": [[30, 3], [50, 5]])"), Contains("/site/sources/0: it lies outside the site"));
    CHECK(refused(R"("polygon": [[3, 3], [12, 3], [12, 5]])").empty());
    CHECK(refused(R"("line": [[0, 0], [0, 10]])").empty());
    CHECK_THAT(load_or_refusal(R"("outlets": [{"line": [[30, 3], [50, 5]]}])"),
               Contains("/site/outlets/0: it lies outside"));
    CHECK_THAT(load_or_refusal(R"("shelters": [{"polygon": [[30, 3], [50, 5], [50, 3]]}])"),
               Contains("/site/shelters/0: it lies outside"));
}

TEST_CASE("people who start in a wall or without ground are refused, and so are other models of the water") {
    const auto people = [](double x, double z) {
        return R"(, "crowd": {"groups": [{"name": "a", "start": {"x_m": )" + std::to_string(x) + R"(, "z_m": )" +
               std::to_string(z) + R"(}, "goal": {"x_m": 18, "z_m": 2}}]})";
    };
    CHECK_THAT(load_or_refusal(hut, ground_raster(), people(3, 3)),
               Contains("/crowd/groups/0/start: agent 0 at x 3 m, z 3 m starts in the house /site/houses/0"));
    CHECK(load_or_refusal(hut, ground_raster(), people(9, 9)).empty());
    CHECK_THAT(load_or_refusal(hut, ground_raster("10", "-9999"), people(19.5, 0.5)),
               Contains("where the ground has no height"));
    CHECK_THAT(load_or_refusal("", ground_raster(), R"(, "fluid": {"model": "kinematic"})"),
               Contains("/fluid/model: \"kinematic\" knows no ground but a channel's bed; allowed beside /site: "
                        "\"shallow_water\", \"dfsph\""));
}

TEST_CASE("gaps between houses that are too narrow for particles are told with the spacing that they need") {
    wade::Scene scene;
    scene.world->length = 20, scene.world->width = 10;
    scene.channel->flow = wade::Flow::closed;
    scene.channel->x = {0, 20}, scene.channel->z = {0, 10};
    scene.fluid->particle_spacing = 0.5;
    const auto house = [](const std::string& name, wade::MapLine ring) {
        wade::House made;
        made.label = name;
        made.polygon.rings = {std::move(ring)};
        return made;
    };
    // A turned house 0.5 m from the next, which touches a third and overlaps a fourth; a fifth is 0.7 m from the edge.
    scene.site.emplace();
    scene.site->houses = {
        house("a", {{3, 3}, {5, 5}, {3, 7}, {1, 5}}), house("b", {{5.5, 3}, {8, 3}, {8, 7}, {5.5, 7}}),
        house("c", {{8, 3}, {10, 3}, {10, 7}, {8, 7}}), house("d", {{9, 2}, {11, 2}, {11, 4}, {9, 4}}),
        house("e", {{17, 3}, {19.3, 3}, {19.3, 7}, {17, 7}})};
    const std::vector<std::string> gaps = wade::narrow_gaps(scene);
    REQUIRE(gaps.size() == 3);
    CHECK_THAT(gaps[0], Contains("the gap of 0.5 m between a and b is 1 particle spacings wide"));
    CHECK_THAT(gaps[1], Contains("the gap of 0.7 m between e and the site's edge at x 20"));
    CHECK_THAT(gaps[2], Contains("the gap of 1 m between a and the site's edge at x 0"));
    scene.fluid->model = wade::ModelKind::shallow_water;
    CHECK(wade::narrow_gaps(scene).empty());
}

TEST_CASE("particles on a site are refused rain, stages, gaps in the ground, and more water than there is room") {
    const std::string particles = R"(, "fluid": {"model": "dfsph", "particle_spacing_m": 0.5})";
    const std::string lake = R"("water": [{"level_m": 12}])";
    CHECK(load_or_refusal(lake, ground_raster(), particles).empty());
    CHECK_THAT(load_or_refusal(R"("rain": {"rate_mm_h": 20})", ground_raster(), particles),
               Contains("/site/rain: particles are too large for drops"));
    for (const std::string kind : {"stage", "wave"}) {
        CHECK_THAT(
            load_or_refusal(R"("outlets": [{"line": [[0, 3], [0, 5]], "level_m": 11, "kind": ")" + kind + R"("}])",
                            ground_raster(), particles),
            Contains("/site/outlets/0/kind: \"" + kind + "\": particles only leave"));
    }
    CHECK_THAT(load_or_refusal(lake, ground_raster("10", "-9999"), particles),
               Contains("/site/ground/file") && Contains("particles need ground all over"));
    CHECK_THAT(load_or_refusal(lake, ground_raster(), R"(, "fluid": {"model": "dfsph", "publish": "near_agents"},
                                               "coupling": {"agents_stream": "parallel"})"),
               Contains("/fluid/publish: \"near_agents\" is for columns of water"));
    CHECK_THAT(load_or_refusal(lake, ground_raster(), R"(, "fluid": {"model": "dfsph", "max_particles": 100})"),
               Contains("/fluid/max_particles: 100 particles are too few"));
}

TEST_CASE("people of a site without houses, shelters or a group are refused with the keys that help") {
    const auto crowd = [](const std::string& group) {
        return R"(, "crowd": {"groups": [{"name": "a", )" + group + "}]}";
    };
    const std::string in_houses = R"("start": {"from": "houses"}, "goal": {"to": "shelters"})";
    const std::string shelter = R"(, "shelters": [{"polygon": [[12, 2], [14, 2], [14, 4]]}])";
    const std::string lived_in =
        R"("houses": [{"name": "hut", "polygon": [[2, 2], [8, 2], [8, 8], [2, 8]], "residents": 3}])";
    CHECK(load_or_refusal(lived_in + shelter, ground_raster(), crowd(in_houses)).empty());
    CHECK_THAT(load_or_refusal(lived_in, ground_raster(), crowd(in_houses)),
               Contains("/crowd/groups/0/goal/to: \"shelters\": the site has none"));
    CHECK_THAT(load_or_refusal(hut + shelter, ground_raster(), crowd(in_houses)),
               Contains("/crowd/groups/0/start/from: no people live in houses of group \"a\""));
    CHECK(load_or_refusal(lived_in + shelter).empty());  // a site without people
    CHECK_THAT(load_or_refusal(lived_in + shelter, ground_raster(),
                               crowd(R"("start": {"x_m": 1, "z_m": 1}, "goal": {"to": "shelters"})")),
               Contains("the site has residents, and no group starts in houses"));
    CHECK_THAT(
        load_or_refusal(hut, ground_raster(), crowd(R"("start": {"x_m": 1, "z_m": 1}, "goal": {"x_m": 4, "z_m": 4})")),
        Contains("/crowd/groups/0/goal: the goal of group \"a\"") && Contains("is in the house"));
    CHECK_THAT(load_or_refusal(hut, ground_raster(), crowd(R"("start": {"x_m": 1}, "goal": {"x_m": 1, "z_m": 1})")),
               Contains("/crowd/groups/0/start: the required key \"z_m\" is missing"));
    CHECK_THAT(load_or_refusal(lived_in + shelter, ground_raster(),
                               crowd(in_houses + R"(, "leaves": {"rule": "table", "table": [{"time_s": 5, "share": 0.5},
                                                                                    {"time_s": 4, "share": 0.6}]})")),
               Contains("/crowd/groups/0/leaves/table/1: time 4 s, share 0.6 go back"));
}

TEST_CASE("outlets that share cells with an outlet or a source are refused, those that touch end to end are not") {
    const auto of = [](const std::string& keys) {
        return load_or_refusal(keys, ground_raster(), R"(, "fluid": {"shallow_water": {"cell_size_m": 1}})");
    };
    const auto line = [](const std::string& points, const std::string& more = "") {
        return R"({"line": [)" + points + "]" + more + "}";
    };
    const auto area = [](const std::string& points, const std::string& more = "") {
        return R"({"polygon": [)" + points + "]" + more + "}";
    };
    const auto two = [&](const std::string& a, const std::string& b) {
        return of(R"("outlets": [)" + a + ", " + b + "]");
    };
    const std::string west = "[0, 2.1], [0, 7.9]", sea = R"(, "name": "sea", "kind": "stage", "level_m": 11)",
                      wave = R"(, "kind": "wave", "level_m": 11)", box = "[0, 2], [3, 2], [3, 6], [0, 6]";
    const auto clash = [](int cells, int of_cells, const std::string& other = "") {
        return "/site/outlets/1: it covers " + std::to_string(cells) + " of the " + std::to_string(of_cells) +
               " cells of 1 m of /site/outlets/0" + other + ", the first at x ";
    };
    CHECK_THAT(
        two(line(west, sea), line(west, sea)),
        Contains("scene.json: /site/outlets/1 (sea): it covers 6 of the 6 cells of 1 m of /site/outlets/0 (sea), "
                 "the first at x 0.5 m, z 2.5 m; allowed: an outlet beside it, end to end"));
    for (const std::string& kind : {std::string(), sea, wave})
        CHECK_THAT(two(line(west, kind), line("[0, 7.9], [0, 2.1]")),
                   Contains(clash(6, 6, kind == sea ? " (sea)" : "")));
    CHECK_THAT(two(line(west, wave), line("[0.3, 6.5], [0.4, 9.5]")), Contains(clash(2, 6)));
    CHECK_THAT(two(line(west), line("[0, 5], [4, 5]")), Contains(clash(1, 6)));  // starts in its middle
    CHECK_THAT(two(line(west), line("[0, 1.2], [0, 1.8], [0.5, 9]")), Contains(clash(6, 6)));
    CHECK_THAT(two(line("[0, 4], [0, 4.9]"), line("[0, 4.5], [0, 8]")),
               Contains(clash(1, 1)));  // has no cell of its own
    CHECK_THAT(two(area(box), area("[2, 3], [6, 3], [6, 5], [2, 5]")), Contains(clash(2, 12)));
    CHECK_THAT(two(area(box, sea), area(box)), Contains(clash(12, 12, " (sea)")));
    CHECK_THAT(two(area(box), line(west)), Contains(clash(4, 12)));
    CHECK_THAT(two(line(west), area(box)), Contains(clash(4, 6)));
    CHECK_THAT(of(R"("outlets": [)" + line(west) + R"(], "sources": [)" + line(west, R"(, "discharge_m3_s": 1)") + "]"),
               Contains("/site/sources/0: it covers 6 of the 6 cells of 1 m of /site/outlets/0") &&
                   Contains("allowed: a source beside it, end to end, as what comes in there would leave at once"));
    CHECK_THAT(of(R"("outlets": [)" + area(box) + R"(], "sources": [)" +
                  area("[2, 3], [6, 3], [6, 5], [2, 5]", R"(, "discharge_m3_s": 1)") + "]"),
               Contains("/site/sources/0: it covers 2 of the 12 cells"));

    for (const std::string next :
         {"[0, 7.9], [0, 10]", "[0, 8], [0, 10]", "[0, 8.3], [0, 10]", "[0, 0], [0, 2.1]", "[1, 2], [1, 8]"})
        CHECK(two(line(west), line(next, sea)).empty());
    CHECK(two(line("[0, 0], [0, 4.4]"), line("[0, 4.4], [0, 10]", wave)).empty());  // both end in one cell
    CHECK(two(line("[0, 10], [0, 0]"), line("[0, 0], [20, 0]")).empty());           // round a corner
    CHECK(two(area(box), area("[3, 2], [6, 2], [6, 6], [3, 6]", sea)).empty());
    CHECK(two(area("[0, 2.5], [3.5, 2.5], [3.5, 6], [0, 6]"), area("[3.5, 2], [6, 2], [6, 6], [3.5, 6]")).empty());
    CHECK(two(area(box), line("[0, 6], [0, 10]")).empty());
    CHECK(two(line("[0, 6.4], [0, 10]"), area("[0, 2], [3, 2], [3, 6.6], [0, 6.6]")).empty());  // ends in its edge
    CHECK(of(R"("outlets": [)" + line(west) + R"(], "sources": [)" +
             line("[0, 8], [0, 10]", R"(, "discharge_m3_s": 1)") + "]")
              .empty());
    // A line 1 m off covers the same cells of 2 m.
    const std::string beside = R"("outlets": [)" + line(west) + ", " + line("[1, 2], [1, 8]") + "]";
    CHECK_THAT(load_or_refusal(beside, ground_raster(), R"(, "fluid": {"shallow_water": {"cell_size_m": 2}})"),
               Contains("cells of 2 m of /site/outlets/0"));
}

TEST_CASE("outlets of files that share cells are named by feature") {
    const wade::test::TemporaryFolder folder;
    const auto feature = [](const std::string& name, int from, int to) {
        const auto at = [](int z) { return "[500100, " + std::to_string(6000200 + z) + "]"; };
        return R"({"type": "Feature", "properties": {"name": ")" + name +
               R"("}, "geometry": {"type": "LineString", "coordinates": [)" + at(from) + ", " + at(to) + "]}}";
    };
    const auto of = [&](const std::string& features) {
        const auto file =
            folder.write("sea.geojson", R"({"type": "FeatureCollection", "features": [)" + features + "]}");
        return load_or_refusal(R"("outlets": [{"kind": "stage", "level_m": 11, "file": ")" + file.string() + R"("}])");
    };
    CHECK_THAT(of(feature("a", 0, 6) + ", " + feature("b", 4, 10)),
               Contains("/site/outlets/0: ") &&
                   Contains("sea.geojson: feature 1 (b): it covers 5 of the 13 cells of 0.5 m of ") &&
                   Contains("sea.geojson: feature 0 (a), the first"));
    CHECK(of(feature("a", 0, 6) + ", " + feature("b", 6, 10)).empty());
}

TEST_CASE("a wave needs water at rest in a cell of its outlet") {
    const auto of = [](const std::string& level, const std::string& points = "[0, 2], [0, 8]",
                       const std::string& raster = ground_raster()) {
        return load_or_refusal(
            R"("outlets": [{"kind": "wave", "level_m": )" + level + R"(, "line": [)" + points + "]}]", raster);
    };
    for (const std::string level : {"9", "10"})
        CHECK_THAT(of(level),
                   Contains("/site/outlets/0: its level at rest, the first one, is " + level +
                            " m, and the lowest bed of its cells is 10 m; allowed with kind \"wave\": a level "
                            "above it") &&
                       Contains("or kind \"stage\""));
    CHECK(of("10.1").empty());
    CHECK(of("9", "[9, 2], [9, 8]", ground_raster("8")).empty());  // one cell is wet
    const TemporaryFolder folder;
    const auto file = folder.write("w.csv", "time_s,level_m\n0,9\n60,12\n");
    CHECK_THAT(
        load_or_refusal(R"("outlets": [{"kind": "wave", "polygon": [[0, 2], [4, 2], [4, 6], [0, 6]], "stage_csv": ")" +
                        file.string() + R"("}])"),
        Contains("/site/outlets/0: its level at rest, the first one, is 9 m"));
    CHECK(load_or_refusal(R"("outlets": [{"kind": "stage", "level_m": 9, "line": [[0, 2], [0, 8]]}])").empty());
}
