// Flood maps: danger scales at their bounds, the largest of each value, and georeferenced files.

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>

#include "configs/files/raster_file.hpp"
#include "configs/files/text_file.hpp"
#include "configs/numbers/hazard.hpp"
#include "fluid_server/maps/flood_maps.hpp"

using namespace wade;
using namespace wade::fluid;

namespace {

struct Folder {
    Folder() {
        std::string name = (std::filesystem::temp_directory_path() / "wade-test-XXXXXX").string();
        if (mkdtemp(name.data()) != nullptr) path = name;
    }
    ~Folder() { std::filesystem::remove_all(path); }
    std::filesystem::path path;
};

}  // namespace

TEST_CASE("hazard classes H1 to H6 change at their bounds of depth, speed and their product") {
    CHECK(hazard_class(0, 3) == 0);
    CHECK((hazard_class(0.3, 1) == 1 && hazard_class(0.301, 0.5) == 2 && hazard_class(0.3, 1.01) == 2));
    CHECK((hazard_class(0.5, 1.2) == 2 && hazard_class(0.501, 1) == 3 && hazard_class(0.6, 1) == 3));
    CHECK((hazard_class(1.2, 0.5) == 3 && hazard_class(1.201, 0.4) == 4 && hazard_class(0.5, 1.9) == 4));
    CHECK((hazard_class(2, 0.5) == 4 && hazard_class(2.01, 0.1) == 5 && hazard_class(0.1, 2.01) == 5));
    CHECK((hazard_class(1, 4) == 5 && hazard_class(1.01, 4) == 6 && hazard_class(4.01, 0) == 6 &&
           hazard_class(0.1, 4.01) == 6));
}

TEST_CASE("the rating of Defra in towns: h (v + 0.5), and 1 for debris in deep or fast water") {
    CHECK(hazard_rating(0, 2) == 0);
    CHECK(hazard_rating(0.25, 2) == Approx(0.625));
    CHECK(hazard_rating(0.5, 1.5) == Approx(2));
    CHECK(hazard_rating(0.2, 2.5) == Approx(1.6));
}

TEST_CASE("gauges read the nearest cell that is no wall, and are written a row a frame") {
    FloodMaps maps({0, 0, 2, 3, 4, 2});
    maps.wall[6] = true;
    Site site;
    site.gauges = {{"mill, old", {5.9, 4}, ""}, {"2", {1, 1}, ""}};  // the first one in the wall, near its right side
    place_gauges(maps, site, {5, 5, 5, 5, 10, 11, 12, 13});
    REQUIRE(maps.gauges.size() == 2);
    CHECK((maps.gauges[0].row == 1 && maps.gauges[0].column == 3 && maps.gauges[0].ground == 13));
    CHECK((maps.gauges[1].row == 0 && maps.gauges[1].column == 0));
    const double dry[] = {0, 0, 0, 0}, h[] = {0, 0, 0, 0.004}, u[] = {0, 0, 0, -1.5}, v[] = {0, 0, 0, 2};
    for (const double time : {0.5, 1.0}) {
        add_row(maps, 0, time, dry, dry, dry);
        add_row(maps, 1, time, time < 1 ? dry : h, u, v);
    }
    const Folder folder;
    write_maps(maps, site, folder.path);
    CHECK(read_text_file(folder.path / "gauges.csv", "gauges.csv") ==
          "time_s,name,depth_m,level_m,velocity_x_m_s,velocity_z_m_s,discharge_x_m2_s,discharge_z_m2_s\n"
          "0.5,\"mill, old\",0,13,-1.5,2,-0,0\n0.5,2,0,5,0,0,0,0\n"
          "1,\"mill, old\",0.004,13.004,-1.5,2,-0.006,0.008\n1,2,0,5,0,0,0,0\n");
    maps.wall.assign(8, true);
    CHECK_THROWS_WITH(place_gauges(maps, site, {}), Catch::Matchers::Contains("the gauge mill, old has walls alone"));
}

TEST_CASE("each map keeps the largest of its own value; thin films are dry, walls have no value") {
    FloodMaps maps({0, 0, 2, 3, 4, 2});
    maps.wall[7] = true;
    const double first_h[] = {0, 0.005, 1, 0.4}, first_u[] = {0, 9, 0.3, 0}, first_v[] = {0, 0, 0.4, 2};
    const double then_h[] = {0, 0.02, 0.2, 0.5}, then_u[] = {0, 0, 2.1, 0}, then_v[] = {0, 1, 0, 0};
    add_row(maps, 1, 5, first_h, first_u, first_v);
    add_row(maps, 1, 7.5, then_h, then_u, then_v);
    CHECK((std::isnan(maps.arrival[4]) && maps.arrival[5] == 7.5F && maps.arrival[6] == 5));
    CHECK((maps.depth[5] == 0.02F && maps.speed[5] == 1));
    CHECK((maps.depth[6] == 1 && maps.speed[6] == 2.1F && maps.depth_speed[6] == 0.5F));
    CHECK((maps.hazard[4] == 0 && maps.hazard[5] == 1 && maps.hazard[6] == 5));
    CHECK(maps.rating[6] == Approx(2));  // of the first moment, 1 (0.5 + 0.5) + 1
    CHECK((maps.depth[2] == 0 && std::isnan(maps.arrival[2])));

    const Folder folder;
    Site site;
    site.epsg = 32756;
    site.origin_x = 500000;
    site.origin_z = 6000000;
    maps.grid.dz = maps.grid.dx;  // the reader takes square cells only
    write_maps(maps, site, folder.path);
    const RasterFile depth = read_raster(folder.path / "maps/max_depth_m.tif");
    CHECK(depth.epsg == 32756);
    CHECK((depth.raster.x == 500000 && depth.raster.z == 6000000 && depth.raster.cell == 2));
    CHECK((depth.raster.at(2, 1) == 1 && depth.raster.at(2, 0) == 0 && std::isnan(depth.raster.at(3, 1))));
    const auto value = [&](const char* map) { return read_raster(folder.path / "maps" / map).raster.at(2, 1); };
    CHECK(
        (value("viseu.tif") == 2 && value("arr_h.tif") == 5 && value("defra.tif") == 2 && value("arrival_s.tif") == 5));
    CHECK((value("max_speed_m_s.tif") == double{2.1F} && value("max_dv_m2_s.tif") == 0.5));
}
