#include <geos_c.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "configs/loading/scene_loader.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/outputs/writers/trajectory_file.hpp"

using namespace wade;
using namespace wade::crowd;

namespace {

// A polygon as GEOS reads it, which refuses rings that are not closed.
struct Polygon {
    bool is_valid = false;
    std::vector<double> rings;  // signed areas, the outer one first; positive: counter-clockwise

    [[nodiscard]] std::size_t holes() const { return rings.size() - 1; }
    [[nodiscard]] double area() const {
        double sum = 0;
        for (const double ring : rings) sum += ring;
        return sum;
    }
};

double signed_area(GEOSContextHandle_t geos, const GEOSGeometry* ring) {
    const GEOSCoordSequence* const points = GEOSGeom_getCoordSeq_r(geos, ring);
    unsigned count = 0;
    GEOSCoordSeq_getSize_r(geos, points, &count);
    std::vector<double> p(2 * count);
    GEOSCoordSeq_copyToBuffer_r(geos, points, p.data(), 0, 0);
    double twice = 0;  // from the first corner, so that small rings far from the origin lose no digits
    for (std::size_t k = 2; k + 3 < p.size(); k += 2)
        twice += (p[k] - p[0]) * (p[k + 3] - p[1]) - (p[k + 2] - p[0]) * (p[k + 1] - p[1]);
    return twice / 2;
}

Polygon polygon_of(const std::string& wkt) {
    const std::unique_ptr<std::remove_pointer_t<GEOSContextHandle_t>, void (*)(GEOSContextHandle_t)> context(
        GEOS_init_r(), GEOS_finish_r);
    GEOSContextHandle_t geos = context.get();
    GEOSWKTReader* const reader = GEOSWKTReader_create_r(geos);
    GEOSGeometry* const read = GEOSWKTReader_read_r(geos, reader, wkt.c_str());
    GEOSWKTReader_destroy_r(geos, reader);
    REQUIRE(read != nullptr);
    Polygon polygon{GEOSisValid_r(geos, read) == 1, {signed_area(geos, GEOSGetExteriorRing_r(geos, read))}};
    for (int k = 0; k < GEOSGetNumInteriorRings_r(geos, read); ++k)
        polygon.rings.push_back(signed_area(geos, GEOSGetInteriorRingN_r(geos, read, k)));
    GEOSGeom_destroy_r(geos, read);
    return polygon;
}

House house(std::vector<MapLine> rings) {
    House made;
    made.polygon.rings = std::move(rings);
    return made;
}

MapLine box(double x0, double z0, double x1, double z1) {
    return {{x0, z0}, {x1, z0}, {x1, z1}, {x0, z1}};
}

Scene scene_with(std::vector<House> houses) {
    Scene scene;
    scene.world->length = 20, scene.world->width = 10;
    scene.site.emplace();
    scene.site->houses = std::move(houses);
    return scene;
}

// Checks all that holds for any walkable area, and its size.
void check_walkable(const Scene& scene, double area, std::size_t holes) {
    const std::string wkt = walkable_area_wkt(scene);
    CAPTURE(wkt.substr(0, 1000));
    const Polygon walkable = polygon_of(wkt);
    CHECK(walkable.is_valid);
    CHECK(walkable.area() == Approx(area).epsilon(1e-9));
    CHECK(walkable.holes() == holes);
    CHECK(walkable.rings.front() > 0);
    for (std::size_t k = 1; k < walkable.rings.size(); ++k) CHECK(walkable.rings[k] < 0);
    CHECK(walkable_area_wkt(scene) == wkt);
}

}  // namespace

TEST_CASE("Holes of the walkable area touch neither its edge nor one another") {
    Scene scene;
    scene.obstacles.push_back({{0, 5}, {10, 20}, 1});
    scene.obstacles.push_back({{40, 50}, {10, 20}, 1});
    scene.obstacles.push_back({{50, 60}, {10, 20}, 1});
    CHECK(walkable_area_wkt(scene) ==
          "POLYGON ((0 0, 100 0, 100 50, 0 50, 0 0), "
          "(0.001 10.001, 4.999 10.001, 4.999 19.999, 0.001 19.999, 0.001 10.001), "
          "(40.001 10.001, 49.999 10.001, 49.999 19.999, 40.001 19.999, 40.001 10.001), "
          "(50.001 10.001, 59.999 10.001, 59.999 19.999, 50.001 19.999, 50.001 10.001))");
}

TEST_CASE("Houses of a site that touch, overlap and have courtyards are holes of the walkable area") {
    const Scene scene =
        scene_with({house({{{4, 4}, {6, 4}, {6, 6}, {4, 6}}}), house({{{6, 4}, {7, 4}, {7, 6}, {6, 6}}}),
                    house({{{10, 2}, {16, 2}, {16, 8}, {10, 8}}, {{12, 4}, {14, 4}, {14, 6}, {12, 6}}}),
                    house({{{18, 8}, {24, 8}, {24, 12}, {18, 12}}})});
    const Polygon area = polygon_of(walkable_area_wkt(scene));
    CHECK(area.is_valid);
    CHECK(area.holes() == 2);  // two houses wall to wall are one; the courtyard is not walked on from outside
    CHECK(area.area() == Approx(200 - 6 - 36 - 4));
}

TEST_CASE("The walkable area of a site has the size that its houses leave") {
    const auto check = [](const std::string& what, double area, std::size_t holes, std::vector<House> houses) {
        CAPTURE(what);
        check_walkable(scene_with(std::move(houses)), area, holes);
    };
    const House square = house({box(2, 2, 6, 6)}), apart = house({box(4, 4, 8, 8)});
    check("a courtyard is no part of the streets", 164, 1, {house({box(4, 2, 10, 8), box(6, 4, 8, 6)})});
    check("houses that overlap", 172, 1, {square, apart});
    // The common square is no house, and touches the street at two corners only.
    check("rings of one house that overlap", 172, 1, {house({box(2, 2, 6, 6), box(4, 4, 8, 8)})});
    check("a common part of an edge", 169, 1, {square, house({box(6, 4, 9, 9)})});
    check("a common corner", 180, 2, {square, house({box(6, 6, 8, 8)})});
    check("beyond the edge of the world", 190, 0, {house({box(18, 8, 24, 12)}), house({box(-5, 4, 3, 6)})});
    check("along the edge of the world", 196, 0, {house({box(0, 0, 2, 2)})});
    check("outside the world", 200, 0, {house({box(30, 30, 40, 40)})});
    check("two parts, the second one is larger", 100, 0, {house({box(8, -1, 10, 11)})});
    check("houses that enclose nothing", 200, 0, {house({}), house({{{2, 2}, {4, 4}}})});
    CHECK(walkable_area_wkt(scene_with({house({box(0, 0, 20, 10)})})) == "POLYGON EMPTY");
    CHECK(walkable_area_wkt(scene_with({house({box(-1, -1, 12, 11)}), house({box(8, -1, 21, 11)})})) ==
          "POLYGON EMPTY");
    CHECK(walkable_area_wkt(scene_with({})) == "POLYGON ((0 0, 20 0, 20 10, 0 10, 0 0))");
}

TEST_CASE("Outlines that touch themselves enclose the points of an odd number of crossings") {
    check_walkable(scene_with({house({{{2, 2}, {4, 4}, {7, 1}, {7, 7}, {4, 4}, {2, 6}}})}), 187, 2);
    check_walkable(scene_with({house({{{2, 2}, {4, 4}, {7, 7}, {7, 1}, {4, 4}, {2, 6}}})}), 187, 2);
    check_walkable(scene_with({house({{{2, 2}, {6, 2}, {6, 6}, {4, 6}, {4, 8}, {4, 6}, {2, 6}}})}), 184, 1);
    check_walkable(scene_with({house({{{2, 2}, {8, 2}, {8, 8}, {2, 8}, {2, 2}, {4, 6}, {6, 4}}})}), 164, 1);
}

TEST_CASE("A house that is no polygon is named") {
    House point = house({{{2, 2}}});
    point.label = "/site/houses/3";
    try {
        (void)walkable_area_wkt(scene_with({house({box(2, 2, 6, 6)}), point}));
        FAIL("it was accepted");
    } catch (const ConfigurationError& error) {
        CHECK_THAT(error.what(), Catch::Matchers::StartsWith("/site/houses/3: "));
        CHECK_THAT(error.what(), Catch::Matchers::Contains("allowed: rings of at least 3 corners"));
    }
}

TEST_CASE("The walkable areas of the sites are those of another library") {
    struct Site {
        double area;  // m2, recorded before GEOS was used
        std::size_t houses;
    };
    const std::map<std::string, Site> sites{{"hamlet.json", {26818.239699999998, 12}},
                                            {"merewether.json", {127526.80430359153, 57}},
                                            {"paper_village.json", {4783.9543999999996, 6}},
                                            {"seaside.json", {813.72940250000011, 168}},
                                            {"village.json", {105895.26334999999, 40}}};
    std::size_t found = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(WADE_SCENES "/sites")) {
        if (entry.path().extension() != ".json") continue;
        CAPTURE(entry.path());
        const Site& site = sites.at(entry.path().filename());
        check_walkable(load_scene(entry.path()).scene, site.area, site.houses);
        ++found;
    }
    CHECK(found == sites.size());
}
