#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/markers/counter_random.hpp"
#include "crowd_client/markers/markers.hpp"

using namespace wade;
using namespace wade::crowd;

namespace {

Scene small_world() {
    Scene scene;
    scene.world->length = 21;
    scene.world->width = 13;
    return scene;
}

double smallest_distance(const Markers& markers) {
    double best = 1e9;
    for (std::size_t i = 0; i < markers.size(); ++i) {
        for (std::size_t j = i + 1; j < markers.size(); ++j) {
            best = std::min(best, std::hypot(markers.x[i] - markers.x[j], markers.z[i] - markers.z[j]));
        }
    }
    return best;
}

}  // namespace

TEST_CASE("Markers keep their minimum distance, also across the borders of cells") {
    const Markers markers = place_markers(small_world());
    CHECK(smallest_distance(markers) >= 0.1);
}

TEST_CASE("Each cell has its number of markers, on the world and round it") {
    const Scene scene = small_world();
    const Markers markers = place_markers(scene);
    for (std::size_t c = 0; c < markers.grid.cells(); ++c) {
        CHECK(markers.cell_start[c + 1] - markers.cell_start[c] == 64);
    }
    const auto [x_lo, x_hi] = std::minmax_element(markers.x.begin(), markers.x.end());
    const auto [z_lo, z_hi] = std::minmax_element(markers.z.begin(), markers.z.end());
    // The border is a cell of 2 m; within 0.5 m of its outer edge a cell of 64 markers has one.
    CHECK(*x_lo < -1.5);
    CHECK(*z_lo < -1.5);
    CHECK(*x_hi > scene.world->length + 1.5);
    CHECK(*z_hi > scene.world->width + 1.5);
}

TEST_CASE("Markers lie in the cell that lists them") {
    const Markers markers = place_markers(small_world());
    for (std::size_t c = 0; c < markers.grid.cells(); ++c) {
        for (std::size_t m = markers.cell_start[c]; m < markers.cell_start[c + 1]; ++m) {
            REQUIRE(markers.grid.cell_of(markers.x[m], markers.z[m]) == c);
        }
    }
}

TEST_CASE("The same seed gives the same markers, another seed gives others") {
    Scene scene = small_world();
    const Markers first = place_markers(scene);
    const Markers again = place_markers(scene);
    CHECK(first.x == again.x);
    CHECK(first.z == again.z);
    scene.seed = 2;
    CHECK(place_markers(scene).x != first.x);
}

TEST_CASE("Obstacles hold no markers and do not change those around them") {
    Scene scene = small_world();
    const Markers open = place_markers(scene);
    const Obstacle box{{5, 9.5}, {3, 6.5}, 1};
    scene.obstacles.push_back(box);
    const Markers blocked = place_markers(scene);
    std::vector<double> kept;
    for (std::size_t m = 0; m < open.size(); ++m) {
        if (!(box.x.contains(open.x[m]) && box.z.contains(open.z[m]))) kept.push_back(open.x[m]);
    }
    CHECK(kept.size() < open.size());
    CHECK(blocked.x == kept);
}

TEST_CASE("Markers are spread evenly") {
    Scene scene;
    scene.world->length = 40;
    scene.world->width = 40;
    const Markers markers = place_markers(scene);
    // Chi square over the four quarters of all cells: 3 degrees of freedom, 21.1 is exceeded once in 10,000 seeds (the
    // minimum distance makes the counts more even than that).
    std::vector<double> quarter(4, 0);
    for (std::size_t m = 0; m < markers.size(); ++m) {
        const bool right = std::fmod(markers.x[m] + 2, 2.0) >= 1;
        const bool upper = std::fmod(markers.z[m] + 2, 2.0) >= 1;
        ++quarter[(right ? 1U : 0U) + (upper ? 2U : 0U)];
    }
    const double expected = static_cast<double>(markers.size()) / 4;
    double chi_square = 0;
    for (const double q : quarter) chi_square += (q - expected) * (q - expected) / expected;
    CHECK(chi_square < 21.1);
}

TEST_CASE("Markers that cannot fit are refused with the keys and values") {
    Scene scene = small_world();
    scene.crowd->markers_per_cell = 900;
    CHECK_THROWS_WITH(place_markers(scene), Catch::Contains("/crowd/markers_per_cell: 900") &&
                                                Catch::Contains("0.1 m (/crowd/marker_min_distance_m)"));
    scene.crowd->markers_per_cell = 64;
    scene.crowd->perception_radius = 2.5;
    CHECK_THROWS_WITH(place_markers(scene),
                      Catch::Contains("/crowd/perception_radius_m is 2.5") && Catch::Contains("up to 2"));
    scene.crowd->perception_radius = 1;
    scene.world->length = scene.world->width = 100000;
    CHECK_THROWS_WITH(place_markers(scene),
                      Catch::Contains("64 markers in each of the 2500") && Catch::Contains("make the world smaller"));
}

TEST_CASE("A draw of the counter-based generator depends on seed, stream and counter alone and fills [0, 1)") {
    CHECK(counter_uniform(1, 2, 3) == counter_uniform(1, 2, 3));
    CHECK(counter_uniform(1, 2, 3) != counter_uniform(2, 2, 3));
    CHECK(counter_uniform(1, 2, 3) != counter_uniform(1, 3, 3));
    CHECK(counter_uniform(1, 2, 3) != counter_uniform(1, 2, 4));
    double sum = 0;
    const int n = 100000;
    for (int i = 0; i < n; ++i) {
        const double u = counter_uniform(7, static_cast<std::uint64_t>(i % 10), static_cast<std::uint64_t>(i));
        REQUIRE(u >= 0);
        REQUIRE(u < 1);
        sum += u;
    }
    // Standard deviation of the mean: sqrt(1/12/n) = 0.00091; five of them.
    CHECK(sum / n == Approx(0.5).margin(0.0046));
}
