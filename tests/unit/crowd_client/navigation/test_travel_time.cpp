#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "configs/scene/obstacle.hpp"
#include "crowd_client/markers/counter_random.hpp"
#include "crowd_client/navigation/monotone_queue.hpp"
#include "crowd_client/navigation/travel_time.hpp"

using namespace wade;
using namespace wade::crowd;

namespace {

using Starts = std::vector<std::pair<std::uint32_t, double>>;

// Exact distances on the disc round a source.
Starts disc(const TravelGrid& grid, const Vector2d& source, double radius) {
    Starts starts;
    for (int row = 0; row < grid.rows; ++row) {
        for (int column = 0; column < grid.columns; ++column) {
            const double d = (grid.place(column, row) - source).norm();
            if (d <= radius) starts.emplace_back(grid.node(column, row), d);
        }
    }
    return starts;
}

std::vector<double> travel_times(const TravelGrid& grid, const Starts& starts, std::span<const double> slowness = {}) {
    std::vector<double> travel;
    MarchMemory memory;
    march(travel, memory, grid, slowness, starts);
    return travel;
}

double largest_error_on_free_ground(double cell_x, double cell_z) {
    TravelGrid grid = travel_grid({0, 0}, {40, 40}, cell_x);
    grid.rows = static_cast<int>(40 / cell_z) + 1;
    grid.dz = cell_z;
    grid.closed.assign(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows), 0);
    const Vector2d source(20, 20);
    const std::vector<double> travel = travel_times(grid, disc(grid, source, 4));
    double worst = 0;
    for (int row = 0; row < grid.rows; ++row) {
        for (int column = 0; column < grid.columns; ++column) {
            const double d = (grid.place(column, row) - source).norm();
            worst = std::max(worst, std::abs(travel[grid.node(column, row)] - d));
        }
    }
    return worst;
}

// From (10, 20) round a block of 2 x 20 m to (30, 20), less the length of a taut string: along the diagonals of two
// squares and the short side.
double error_round_a_block(double cell) {
    TravelGrid grid = travel_grid({0, 0}, {40, 40}, cell);
    close_box(grid, {{19, 21}, {10, 30}, 1});
    const std::vector<double> travel = travel_times(grid, disc(grid, {10, 20}, 4));
    const double taut = 2 * std::hypot(9, 10) + 2;
    const int column = static_cast<int>(std::lround(30 / cell)), row = static_cast<int>(std::lround(20 / cell));
    return travel[grid.node(column, row)] - taut;
}

bool is_reached(const std::vector<double>& travel, const TravelGrid& grid, double x, double z) {
    const int column = static_cast<int>(std::lround((x - grid.origin.x()) / grid.dx));
    const int row = static_cast<int>(std::lround((z - grid.origin.y()) / grid.dz));
    return std::isfinite(travel[grid.node(column, row)]);
}

}  // namespace

// The truncation error of the upwind differences is at most h / (2 r) a metre at the distance r of a point source, so that
// the time is wrong by at most (h / 2) ln(28 m / 4 m) = 1.0 h from a disc of 4 m to the corners.
TEST_CASE("Travel times over free ground are distances, within 1.5 cells") {
    CHECK(largest_error_on_free_ground(1, 1) < 1.5);
    CHECK(largest_error_on_free_ground(0.5, 0.5) < 0.75);
    CHECK(largest_error_on_free_ground(0.25, 0.25) < 0.375);
    CHECK(largest_error_on_free_ground(0.5, 1) < 1.5);
}

TEST_CASE("The error of travel times halves with the cells") {
    const double coarse = largest_error_on_free_ground(1, 1), fine = largest_error_on_free_ground(0.5, 0.5);
    CHECK(coarse / fine > 1.7);
    CHECK(coarse / fine < 2.3);
}

// A corner is a source without a disc of exact times: (h / 2) ln(14 m / h) on the second leg, 2 h at 0.25 m.
TEST_CASE("The travel time round an obstacle is the length of a taut string") {
    const double coarse = error_round_a_block(0.5), fine = error_round_a_block(0.25);
    CHECK(std::abs(coarse) < 3 * 0.5);
    CHECK(std::abs(fine) < 3 * 0.25);
    CHECK(std::abs(fine) < std::abs(coarse));
}

TEST_CASE("Where people walk at half the speed, the travel time rises twice as fast") {
    const TravelGrid grid = travel_grid({0, 0}, {20, 4}, 0.5);
    Starts starts;
    std::vector<double> slowness;
    for (int row = 0; row < grid.rows; ++row) {
        starts.emplace_back(grid.node(0, row), 0.0);
        for (int column = 0; column < grid.columns; ++column) slowness.push_back(column > 20 ? 2 : 1);
    }
    const std::vector<double> travel = travel_times(grid, starts, slowness);
    // A plane wave along the grid is exact; nodes up to 10 m are fast.
    CHECK(travel[grid.node(20, 4)] == Approx(10).epsilon(1e-12));
    CHECK(travel[grid.node(40, 4)] == Approx(30).epsilon(1e-12));
}

TEST_CASE("A wall that is thinner than a cell is not walked through") {
    TravelGrid grid = travel_grid({0, 0}, {20, 20}, 1);
    close_box(grid, {{10.3, 10.5}, {-1, 15}, 1});
    const Starts starts{{grid.node(2, 2), 0.0}};
    CHECK(travel_times(grid, starts)[grid.node(18, 2)] > std::hypot(8, 13) + std::hypot(8, 13) - 1);
    close_box(grid, {{10.3, 10.5}, {14.9, 21}, 1});
    CHECK_FALSE(is_reached(travel_times(grid, starts), grid, 18, 2));
    CHECK_FALSE(is_reached(travel_times(grid, starts), grid, 18, 18));
    CHECK(is_reached(travel_times(grid, starts), grid, 10, 20));
}

TEST_CASE("A closed court has no travel time, and a box beyond the grid closes nothing") {
    TravelGrid grid = travel_grid({0, 0}, {20, 20}, 0.5);
    for (const Obstacle& box : {Obstacle{{30, 40}, {0, 20}, 1}, Obstacle{{-9, -1}, {0, 20}, 1}}) close_box(grid, box);
    CHECK(std::all_of(grid.closed.begin(), grid.closed.end(), [](std::uint8_t bits) { return bits == 0; }));
    const Starts starts{{grid.node(0, 0), 0.0}};
    for (const Obstacle& box : {Obstacle{{5, 15}, {5, 6}, 1}, Obstacle{{5, 15}, {14, 15}, 1},
                                Obstacle{{5, 6}, {5, 15}, 1}, Obstacle{{14, 15}, {5, 15}, 1}}) {
        close_box(grid, box);
    }
    const std::vector<double> travel = travel_times(grid, starts);
    CHECK_FALSE(is_reached(travel, grid, 10, 10));
    CHECK_FALSE(is_reached(travel, grid, 5.5, 10));
    CHECK(is_reached(travel, grid, 20, 20));
}

TEST_CASE("The queue of a march gives the order of pairs of time and node") {
    MonotoneQueue queue;
    std::vector<std::pair<double, std::uint32_t>> expected{{0, 3}, {0, 1}, {0.25, 2}};
    for (const auto& [time, node] : expected) queue.push(time, node);
    for (std::uint64_t draw = 0; !expected.empty(); ++draw) {
        const auto least = std::min_element(expected.begin(), expected.end());
        const auto [time, node] = *least;
        REQUIRE(queue.pop() == node);
        expected.erase(least);
        for (const std::uint64_t k : {2 * draw, 2 * draw + 1}) {
            if (k > 2000) break;
            // Some of the times are equal to the last or to one another.
            const double later = time + std::floor(8 * counter_uniform(1, 0, k)) * 0x1p-30;
            const auto other = static_cast<std::uint32_t>(1000 * counter_uniform(1, 1, k));
            queue.push(later, other);
            expected.emplace_back(later, other);
        }
    }
    CHECK(queue.empty());
}
