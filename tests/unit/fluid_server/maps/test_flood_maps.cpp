// Maps of a flood: scales of danger at their bounds, the largest of each value, and files with their place on the map.

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>

#include "configs/files/raster_file.hpp"
#include "configs/numbers/hazard.hpp"
#include "fluid_server/maps/flood_maps.hpp"

using namespace wade;
using namespace wade::fluid;

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

    std::string name = (std::filesystem::temp_directory_path() / "wade-test-XXXXXX").string();
    REQUIRE(mkdtemp(name.data()) != nullptr);
    Place place;
    place.epsg = 32756;
    place.origin_x = 500000;
    place.origin_z = 6000000;
    maps.grid.dz = maps.grid.dx;  // the reader takes square cells only
    write_maps(maps, place, name);
    const RasterFile depth = read_raster(std::filesystem::path(name) / "maps/max_depth_m.tif");
    CHECK(depth.epsg == 32756);
    CHECK((depth.raster.x == 500000 && depth.raster.z == 6000000 && depth.raster.cell == 2));
    CHECK((depth.raster.at(2, 1) == 1 && depth.raster.at(2, 0) == 0 && std::isnan(depth.raster.at(3, 1))));
    const auto value = [&](const char* map) {
        return read_raster(std::filesystem::path(name) / "maps" / map).raster.at(2, 1);
    };
    CHECK(
        (value("viseu.tif") == 2 && value("arr_h.tif") == 5 && value("defra.tif") == 2 && value("arrival_s.tif") == 5));
    CHECK((value("max_speed_m_s.tif") == double{2.1F} && value("max_dv_m2_s.tif") == 0.5));
    std::filesystem::remove_all(name);
}
