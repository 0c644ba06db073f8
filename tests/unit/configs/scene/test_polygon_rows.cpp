// Points of a grid in a polygon are exactly the points that contains() accepts.

#include <catch2/catch.hpp>
#include <cmath>

#include "configs/numbers/splitmix.hpp"
#include "configs/scene/polygon_rows.hpp"

TEST_CASE("the points of a grid in a polygon are those that it contains, on edges and corners too") {
    const wade::PointGrid grid{23, 17, 1, 1};
    std::uint64_t n = 0;
    const auto number = [&n] { return double(wade::mix_bits(++n * wade::splitmix_step) % 60) / 2 - 3; };
    for (int polygon_number = 0; polygon_number < 300; ++polygon_number) {
        wade::MapPolygon polygon;
        for (int ring = 0; ring < 1 + polygon_number % 3; ++ring) {
            polygon.rings.emplace_back();
            for (int k = 0; k < 3 + polygon_number % 7; ++k) polygon.rings.back().push_back({number(), number()});
        }
        std::vector<bool> visited(23 * 17);
        wade::for_each_point_in(polygon, grid,
                                [&](int column, int row) { visited[std::size_t(row * 23 + column)] = true; });
        bool same = true;
        for (int row = 0; row < 17; ++row) {
            for (int column = 0; column < 23; ++column)
                same = same && visited[std::size_t(row * 23 + column)] == contains(polygon, grid.at(column, row));
        }
        CHECK(same);
    }
}
