#include <boost/geometry.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/polygon.hpp>
#include <catch2/catch.hpp>

#include "configs/scene/world.hpp"
#include "crowd_client/outputs/writers/trajectory_file.hpp"

using namespace wade;
using namespace wade::crowd;

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

TEST_CASE("Houses of a place that touch, overlap and have courtyards are holes of the walkable area") {
    Scene scene;
    scene.world->length = 20, scene.world->width = 10;
    const auto house = [](std::vector<MapLine> rings) {
        House made;
        made.polygon.rings = std::move(rings);
        return made;
    };
    scene.place.emplace();
    scene.place->houses = {house({{{4, 4}, {6, 4}, {6, 6}, {4, 6}}}), house({{{6, 4}, {7, 4}, {7, 6}, {6, 6}}}),
                           house({{{10, 2}, {16, 2}, {16, 8}, {10, 8}}, {{12, 4}, {14, 4}, {14, 6}, {12, 6}}}),
                           house({{{18, 8}, {24, 8}, {24, 12}, {18, 12}}})};
    namespace geometry = boost::geometry;
    geometry::model::polygon<geometry::model::d2::point_xy<double>, false> area;
    geometry::read_wkt(walkable_area_wkt(scene), area);
    CHECK(geometry::is_valid(area));
    CHECK(area.inners().size() == 2);  // two houses wall to wall are one; the courtyard is not walked on from outside
    CHECK(geometry::area(area) == Approx(200 - 6 - 36 - 4));
}
