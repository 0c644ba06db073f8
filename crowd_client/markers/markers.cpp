#include "crowd_client/markers/markers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/markers/counter_random.hpp"
#include "crowd_client/markers/lanes.hpp"

namespace wade::crowd {
namespace {

// A random sequence that fills the plane stops near an area fraction of discs of 0.55, and slows down far below that.
constexpr int attempts_per_marker = 2000;

// Markers of a cell, m. Entries from `count` on, up to a whole vector, are far away.
struct Points {
    std::vector<double> x, z;
    std::size_t count = 0;

    void clear_for(std::size_t most) {
        constexpr double far_away = 1e15;
        x.assign(Lanes<double>::padded(most), far_away);
        z.assign(Lanes<double>::padded(most), far_away);
        count = 0;
    }
    void add(double at_x, double at_z) {
        x[count] = at_x;
        z[count++] = at_z;
    }
    void shift_x(double by) {
        for (double& at : x) at += by;
    }
};

// Tests all points, because a loop without an early end becomes vector code.
bool far_from_all(const Points& others, double x, double z, double min_distance) {
    const double limit = min_distance * min_distance;
    const std::size_t places = Lanes<double>::padded(others.count);
    const double* const at_x = others.x.data();
    const double* const at_z = others.z.data();
    std::uint64_t close = 0;
#pragma omp simd reduction(+ : close)
    for (std::size_t k = 0; k < places; ++k) {
        const double dx = at_x[k] - x, dz = at_z[k] - z;
        close += dx * dx + dz * dz < limit ? 1U : 0U;
    }
    return close == 0;
}

// Bitmap of the squares of a cell that have markers. A square is a little wider than the minimum distance, so that a
// marker with none in the 3 x 3 squares around it is far from all. Most are, and need no test of the others.
class Squares {
 public:
    explicit Squares(double min_distance) {
        constexpr double most = 61;
        lines_per_metre_ =
            std::min(most, std::floor(GroundGrid::cell_size / (1.000001 * min_distance))) / GroundGrid::cell_size;
    }
    void clear() { rows_.fill(0); }
    void add(double u, double w) { rows_[line_of(w) + 1] |= std::uint64_t{2} << line_of(u); }
    [[nodiscard]] bool has_none_round(double u, double w) const {
        const std::size_t row = line_of(w);
        return ((rows_[row] | rows_[row + 1] | rows_[row + 2]) >> line_of(u) & 7U) == 0;
    }

 private:
    [[nodiscard]] std::size_t line_of(double along) const { return static_cast<std::size_t>(along * lines_per_metre_); }

    double lines_per_metre_ = 0;            // squares along an axis over the cell's side
    std::array<std::uint64_t, 64> rows_{};  // with one below and one above
};

bool inside_obstacle(const PlacedBoxes& obstacles, double x, double z) {
    return any_near(obstacles, {x, x}, {z, z}, [&](const Obstacle& o) { return o.x.contains(x) && o.z.contains(z); });
}

// The darts of a cell from its lower corner, m: attempts [from, from + count). Many at once, for the lanes of a vector.
struct Darts {
    static constexpr std::uint64_t count = 32;
    std::array<double, count> u, w;

    void take(std::uint64_t key, std::uint64_t from) {
#pragma omp simd
        for (std::uint64_t i = 0; i < count; ++i) {
            u[i] = counter_uniform(key, 2 * (from + i)) * GroundGrid::cell_size;
            w[i] = counter_uniform(key, 2 * (from + i) + 1) * GroundGrid::cell_size;
        }
    }
};

constexpr double most_markers = 2e8;  // 16 bytes each; also keeps their numbers within 32 bits

// Redrawn markers stand in sub-cells, one in each.
bool fits_sub_cells(const Crowd& crowd) {
    const long side = std::lround(std::sqrt(crowd.markers_per_cell));
    return side * side == crowd.markers_per_cell &&
           crowd.marker_min_distance * static_cast<double>(side) <= GroundGrid::cell_size;
}

void check_ranges(const Crowd& crowd, const GroundGrid& grid) {
    std::ostringstream message;
    if (!(crowd.perception_radius > 0 && crowd.perception_radius <= GroundGrid::cell_size)) {
        message << "/crowd/perception_radius_m is " << crowd.perception_radius << ", allowed is more than 0 up to "
                << GroundGrid::cell_size << " (the size of a cell)";
    } else if (!(crowd.marker_min_distance >= 0 && crowd.marker_min_distance <= GroundGrid::cell_size)) {
        message << "/crowd/marker_min_distance_m is " << crowd.marker_min_distance << ", allowed is 0 up to "
                << GroundGrid::cell_size << " (the size of a cell)";
    } else if (crowd.markers_per_cell < 1) {
        message << "/crowd/markers_per_cell is " << crowd.markers_per_cell << ", allowed is 1 or more";
    } else if (crowd.markers == MarkerRule::redrawn && !fits_sub_cells(crowd)) {
        message << "/crowd/markers_per_cell is " << crowd.markers_per_cell
                << ", with redrawn markers allowed is a square "
                << "number (16, 25, 36, 49, 64, ...) with sub-cells, 2 m / its root, that are at least "
                << crowd.marker_min_distance << " m wide (/crowd/marker_min_distance_m)";
    } else if (static_cast<double>(grid.cells()) * crowd.markers_per_cell > most_markers) {
        message << "/crowd/markers_per_cell: " << crowd.markers_per_cell << " markers in each of the " << grid.cells()
                << " cells of the world are more than " << most_markers << " in all; make the world smaller";
    } else {
        return;
    }
    throw ConfigurationError(message.str());
}

[[noreturn]] void refuse_density(const Crowd& crowd) {
    std::ostringstream message;
    message << "/crowd/markers_per_cell: " << crowd.markers_per_cell << " markers at a distance of at least "
            << crowd.marker_min_distance << " m (/crowd/marker_min_distance_m) do not fit into a cell of 2 x 2 m";
    throw ConfigurationError(message.str());
}

DrawnMarkers drawn_markers(const Scene& scene, const GroundGrid& grid) {
    const Crowd& crowd = scene.crowd;
    DrawnMarkers drawn;
    drawn.grid = grid;
    drawn.ring = scene.world->period() > 0;
    const auto side = std::lround(std::sqrt(crowd.markers_per_cell));
    const double pitch = GroundGrid::cell_size / static_cast<double>(side);
    drawn.jitter = static_cast<float>(pitch - crowd.marker_min_distance);
    const double least = (crowd.marker_min_distance - GroundGrid::cell_size) / 2;
    for (long j = 0; j < side; ++j) {
        for (long i = 0; i < side; ++i) {
            drawn.first_x.push_back(static_cast<float>(least + pitch * static_cast<double>(i)));
            drawn.first_z.push_back(static_cast<float>(least + pitch * static_cast<double>(j)));
        }
    }
    drawn.seed = scene.seed;
    if (!scene.site) drawn.obstacles = place_boxes(scene.obstacles);
    drawn.houses = houses_of(scene);
    if (crowd.bodies == BodyRule::none) drawn.play = pitch;
    return drawn;
}

}  // namespace

void redraw(DrawnMarkers& drawn, std::uint64_t epoch) {
    constexpr std::uint64_t stream = std::uint64_t{1} << 41;  // apart from the streams of the agents
    drawn.epoch = epoch;
    drawn.moved = drawn.play * Vector2d(counter_uniform(drawn.seed, stream, 2 * epoch),
                                        counter_uniform(drawn.seed, stream, 2 * epoch + 1));
}

std::uint64_t marker_epoch(const Crowd& crowd, std::uint64_t step) {
    if (!(crowd.marker_epoch > 0)) return step;
    // A millionth of a step forgives what rounding takes from a whole number of epochs.
    return static_cast<std::uint64_t>((static_cast<double>(step) + 1e-6) / (crowd.marker_epoch * crowd.step_rate));
}

Markers place_markers(const Scene& scene) {
    const Crowd& crowd = scene.crowd;
    Markers markers;
    markers.grid = GroundGrid::over(scene.world);
    check_ranges(crowd, markers.grid);
    if (crowd.markers == MarkerRule::redrawn) {
        markers.drawn = drawn_markers(scene, markers.grid);
        return markers;
    }
    const GroundGrid& grid = markers.grid;
    const PlacedBoxes obstacles = place_boxes(scene.obstacles);
    const PlacedHouses houses = houses_of(scene);
    const double min_distance = crowd.marker_min_distance;
    const auto wanted = static_cast<std::size_t>(crowd.markers_per_cell);

    // Columns that appear twice in a periodic world: the last one stands before the first, the first behind the last.
    const double period = scene.world->period();
    const int last_column = grid.columns - 3;

    // Only the row below and the current row are needed to keep the distance across borders.
    std::array<std::vector<Points>, 2> placed;
    placed.fill(std::vector<Points>(static_cast<std::size_t>(grid.columns)));
    markers.cell_start.reserve(grid.cells() + 1);
    markers.cell_start.push_back(0);
    markers.x.reserve(grid.cells() * wanted);
    markers.z.reserve(grid.cells() * wanted);
    Darts darts;
    Squares squares(min_distance);

    for (int row = 0; row < grid.rows; ++row) {
        std::vector<Points>& here = placed[static_cast<std::size_t>(row % 2)];
        const std::vector<Points>& below = placed[static_cast<std::size_t>((row + 1) % 2)];
        const double z0 = GroundGrid::line_start(row);
        if (period > 0) {
            for (Points& cell : here) cell.clear_for(wanted);
        }
        for (int column = 0; column < grid.columns; ++column) {
            const auto c = static_cast<std::size_t>(column);
            if (period > 0 && (column == 0 || column > last_column)) {
                markers.cell_start.push_back(static_cast<std::uint32_t>(markers.x.size()));
                continue;
            }
            const double x0 = GroundGrid::line_start(column);
            const std::uint64_t key = counter_key(scene.seed, grid.index(column, row));
            Points& own = here[c];
            own.clear_for(wanted);
            squares.clear();
            const std::uint64_t last_attempt = wanted * attempts_per_marker;
            for (std::uint64_t attempt = 0; own.count < wanted; ++attempt) {
                if (attempt == last_attempt) refuse_density(crowd);
                const std::uint64_t in_block = attempt % Darts::count;
                if (in_block == 0) darts.take(key, attempt);
                const double u = darts.u[in_block], w = darts.w[in_block];
                const double x = x0 + u, z = z0 + w;
                const bool near_left = column > 0 && u < min_distance;
                const bool near_below = row > 0 && w < min_distance;
                const bool near_right = column + 1 < grid.columns && GroundGrid::cell_size - u < min_distance;
                const bool near_joint = period > 0 && column == last_column && near_right;
                if (near_left && !far_from_all(here[c - 1], x, z, min_distance)) continue;
                if (near_below && !far_from_all(below[c], x, z, min_distance)) continue;
                if (near_below && near_left && !far_from_all(below[c - 1], x, z, min_distance)) continue;
                if (near_below && near_right && !far_from_all(below[c + 1], x, z, min_distance)) continue;
                if (near_joint && !far_from_all(here[c + 1], x, z, min_distance)) continue;
                if (!squares.has_none_round(u, w) && !far_from_all(own, x, z, min_distance)) continue;
                own.add(x, z);
                squares.add(u, w);
            }
            if (period > 0 && column == 1) {
                Points& behind = here[static_cast<std::size_t>(last_column) + 1];
                behind = own;
                behind.shift_x(period);
            }
            if (period > 0 && column == last_column) {
                here[0] = own;
                here[0].shift_x(-period);
            }
            for (std::size_t k = 0; k < own.count; ++k) {
                if (inside_obstacle(obstacles, own.x[k], own.z[k])) continue;
                if (is_in_a_house(houses, {own.x[k], own.z[k]})) continue;
                markers.x.push_back(own.x[k]);
                markers.z.push_back(own.z[k]);
            }
            markers.cell_start.push_back(static_cast<std::uint32_t>(markers.x.size()));
        }
    }
    return markers;
}

}  // namespace wade::crowd
