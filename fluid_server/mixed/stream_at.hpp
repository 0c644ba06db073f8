#pragma once
// The shallow water between the middles of its cells.

#include <algorithm>
#include <cmath>

#include "fluid_server/shallow_water/step.hpp"

namespace wade::fluid::mixed {

struct Stream {
    double h = 0;           // depth of the cell, m
    double u = 0, v = 0;    // bilinear between the middles of cells, m/s
    double divergence = 0;  // du/dx + dv/dz of the same, 1/s
};

// At a place in the channel. The ghost cells stand in for what lies beyond its border.
inline Stream stream_at(const shallow_water::ShallowWater& world, double x, double z) {
    const shallow_water::Grid& grid = world.grid;
    const double a = (x - grid.x.lo) / grid.dx - 0.5, b = (z - grid.z.lo) / grid.dz - 0.5;
    const double i = std::clamp(std::floor(a), -1.0, static_cast<double>(grid.nx) - 1);
    const double k = std::clamp(std::floor(b), -1.0, static_cast<double>(grid.nz) - 1);
    const double s = std::clamp(a - i, 0.0, 1.0), t = std::clamp(b - k, 0.0, 1.0);
    const std::size_t c = static_cast<std::size_t>(
        static_cast<std::ptrdiff_t>(grid.row(static_cast<std::ptrdiff_t>(k))) + static_cast<std::ptrdiff_t>(i));
    const auto& u = world.primitive.u;
    const auto& v = world.primitive.v;
    const std::size_t up = c + grid.stride;
    Stream stream;
    stream.h = world.primitive.h[c + (s < 0.5 ? 0 : 1) + (t < 0.5 ? 0 : grid.stride)];
    stream.u = (1 - t) * ((1 - s) * u[c] + s * u[c + 1]) + t * ((1 - s) * u[up] + s * u[up + 1]);
    stream.v = (1 - t) * ((1 - s) * v[c] + s * v[c + 1]) + t * ((1 - s) * v[up] + s * v[up + 1]);
    stream.divergence = ((1 - t) * (u[c + 1] - u[c]) + t * (u[up + 1] - u[up])) / grid.dx +
                        ((1 - s) * (v[up] - v[c]) + s * (v[up + 1] - v[c + 1])) / grid.dz;
    return stream;
}

}  // namespace wade::fluid::mixed
