#include "shm_protocol/c_api/columns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>

namespace wade::shm::c_api {
namespace {

constexpr double widest_column = 2;    // m, Header.column_width
constexpr double widest_cell = 1e6;    // m
constexpr double dry_up_to = 0.001;    // m
constexpr double of_water = 1000;      // kg/m3
constexpr double rounding = 1 + 1e-9;  // of a cell size that was computed, as 100.0 / 50

template <typename Value>
[[noreturn]] void refuse(const std::string& name, Value value, const std::string& allowed) {
    std::ostringstream message;
    message << "wade_grid::" << name << " = " << value << " is not allowed; allowed: " << allowed << ".";
    throw std::invalid_argument(message.str());
}

// The columns of a cell along one axis.
struct Division {
    double start, cell;       // lower corner of the grid and width of a cell, m
    std::uint64_t parts = 1;  // of a cell

    Division(const std::string& axis, double start_of_grid, double width) : start(start_of_grid), cell(width) {
        if (!std::isfinite(start)) refuse(axis + "_min", start, "finite");
        if (!(cell > 0 && cell <= widest_cell)) refuse("cell_" + axis, cell, "above 0 and at most 1e6 m");
        parts = static_cast<std::uint64_t>(std::max(1.0, std::ceil(cell / (widest_column * rounding))));
    }
    [[nodiscard]] double width() const { return std::min(widest_column, cell / static_cast<double>(parts)); }
    // The middle of a part of a cell, m.
    [[nodiscard]] double middle(std::uint64_t index, std::uint64_t part) const {
        return start +
               cell * (static_cast<double>(index) + (static_cast<double>(part) + 0.5) / static_cast<double>(parts));
    }
};

struct Divisions {
    Division x, z;
    explicit Divisions(const wade_grid& grid) : x("x", grid.x_min, grid.cell_x), z("z", grid.z_min, grid.cell_z) {
        if (grid.nx == 0) refuse("nx", grid.nx, "1 or more");
        if (grid.nz == 0) refuse("nz", grid.nz, "1 or more");
    }
    [[nodiscard]] std::uint64_t parts() const { return x.parts * z.parts; }
};

// World coordinate to stored value along one axis of the world; scale: m per stored unit, negative for a mirrored axis.
struct StoredAxis {
    double origin, scale;
    float* position;
    float* velocity;

    StoredAxis(const wade_stream& stream, const wade_slot& slot, std::size_t axis)
        : origin(stream.origin[axis]), scale(stream.axes[axis] < 0 ? -stream.metres_per_unit : stream.metres_per_unit) {
        const std::array positions{slot.px, slot.py, slot.pz}, velocities{slot.vx, slot.vy, slot.vz};
        const auto stored = static_cast<std::size_t>(std::abs(stream.axes[axis]) - 1);
        if (stored > 2) throw std::invalid_argument("wade_stream::axes are not 1, 2 and 3 in any order.");
        position = positions[stored];
        velocity = velocities[stored];
    }
    void write(std::size_t to, double place, double speed) const {
        position[to] = static_cast<float>((place - origin) / scale);
        velocity[to] = static_cast<float>(speed / scale);
    }
};

std::string at(const char* field, std::uint32_t i, std::uint32_t j) {
    return std::string(field) + " of cell (" + std::to_string(i) + ", " + std::to_string(j) + ")";
}

// Fill values of file formats, as 9.97e36, are outside of these.
constexpr double deepest = 12000, fastest = 1000, highest = 12000;  // m, m/s, m

double within(const char* field, double value, double limit, std::uint32_t i, std::uint32_t j) {
    if (std::abs(value) <= limit) return value;
    const std::string bound = std::to_string(std::lround(limit));
    refuse(at(field, i, j), value, "-" + bound + " to " + bound + " where there is water");
}

// Depth of a cell, m; 0 where it is dry.
double depth_of(const wade_grid& grid, std::size_t cell, std::uint32_t i, std::uint32_t j) {
    const double depth = grid.depth[cell];
    if (std::isnan(depth)) return 0;
    if (!(depth >= 0 && depth <= deepest)) refuse(at("depth", i, j), depth, "0 to 12000 m, or NaN where it is dry");
    return depth <= dry_up_to ? 0 : depth;
}

}  // namespace

void suit_to_grid(const wade_grid& grid, wade_stream& stream) {
    const Divisions divisions(grid);
    std::uint64_t capacity = 0;
    const std::uint64_t cells = std::uint64_t{grid.nx} * grid.nz;
    if (__builtin_mul_overflow(cells, divisions.parts(), &capacity) ||
        capacity > std::numeric_limits<std::uint32_t>::max())
        refuse("nx * nz", cells, "at most 2^32 - 1 columns of at most 2 m");
    stream.capacity = static_cast<std::uint32_t>(capacity);
    stream.column_width[0] = divisions.x.width();
    stream.column_width[1] = divisions.z.width();
    if (stream.rest_density == 0) stream.rest_density = of_water;
}

std::uint32_t write_columns(const wade_grid& grid, const wade_stream& stream, const wade_slot& slot) {
    const Divisions divisions(grid);
    const double width_x = divisions.x.width(), width_z = divisions.z.width();
    if (stream.column_width[0] != width_x || stream.column_width[1] != width_z || !(stream.rest_density > 0))
        throw std::invalid_argument(
            "wade_stream::column_width or rest_density is not that of this grid: call wade_columns_stream() "
            "before the publisher opens.");
    const StoredAxis x(stream, slot, 0), y(stream, slot, 1), z(stream, slot, 2);
    const double mass_of_depth = stream.rest_density * width_x * width_z;
    std::uint64_t to = 0;
    for (std::uint32_t j = 0; j < grid.nz; ++j) {
        for (std::uint32_t i = 0; i < grid.nx; ++i) {
            const std::size_t cell = std::size_t{j} * grid.nx + i;
            const double depth = depth_of(grid, cell, i, j);
            if (depth == 0) continue;
            const double u = within("u", grid.u[cell], fastest, i, j), v = within("v", grid.v[cell], fastest, i, j);
            const double bed = grid.bed == nullptr ? 0 : within("bed", grid.bed[cell], highest, i, j);
            if (to + divisions.parts() > slot.capacity)
                throw std::invalid_argument("The slot has room for " + std::to_string(slot.capacity) +
                                            " columns, which this grid exceeds: call wade_columns_stream().");
            for (std::uint64_t part = 0; part < divisions.parts(); ++part, ++to) {
                slot.mass[to] = static_cast<float>(mass_of_depth * depth);
                x.write(to, divisions.x.middle(i, part % divisions.x.parts), u);
                y.write(to, bed + 0.5 * depth, 0);
                z.write(to, divisions.z.middle(j, part / divisions.x.parts), v);
            }
        }
    }
    return static_cast<std::uint32_t>(to);
}

}  // namespace wade::shm::c_api
