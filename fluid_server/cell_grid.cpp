#include "fluid_server/cell_grid.hpp"

#include <limits>
#include <utility>

#include "fluid_server/filling.hpp"
#include "fluid_server/parallel.hpp"

namespace wade::fluid {

namespace {

constexpr std::uint32_t no_cell = std::numeric_limits<std::uint32_t>::max();

// Cells above the water at rest, as a multiple of the depth: what is thrown higher counts to the topmost cell.
constexpr double headroom = 3;

template <typename T>
void gather(std::vector<T>& target, const std::vector<T>& values, const std::vector<std::uint32_t>& source,
            std::size_t n) {
    for_each_particle(n, [&](std::size_t i) { target[i] = values[source[i]]; });
}

}  // namespace

CellGrid::CellGrid(const Scene& scene, float support_radius)
    : start_(),
      cell_of_(static_cast<std::size_t>(scene.fluid.max_particles)),
      source_(static_cast<std::size_t>(scene.fluid.max_particles)),
      scratch_(static_cast<std::size_t>(scene.fluid.max_particles)) {
    const Channel& channel = scene.channel;
    periodic_ = {channel.flow == Flow::recirculating || channel.flow == Flow::periodic, channel.top == Top::periodic,
                 channel.sides == Sides::periodic};
    // An emitter holds its next layers behind the upstream end.
    const double behind = channel.flow == Flow::emitter ? 3 * static_cast<double>(support_radius) : 0;
    const std::array<double, 3> lo{channel.x.lo, 0, channel.z.lo};
    const double height = channel.top == Top::open ? headroom * deepest_water(scene) : channel.height;
    const std::array<double, 3> hi{channel.x.hi + behind, height, channel.z.hi};
    for (std::size_t k = 0; k < 3; ++k) {
        const double length = hi[k] - lo[k];
        const int cells = std::max(1, static_cast<int>(length / static_cast<double>(support_radius)));
        origin_[k] = static_cast<float>(lo[k]);
        length_[k] = static_cast<float>(length);
        cells_[k] = cells;
        inverse_cell_[k] = static_cast<float>(cells / length);
    }
    start_.resize(cell_index(0, 0, cells_[2]) + 1);
}

int CellGrid::cell_along(std::size_t axis, float v) const {
    const float cell = (v - origin_[axis]) * inverse_cell_[axis];
    return static_cast<int>(std::clamp(cell, 0.0F, static_cast<float>(cells_[axis] - 1)));
}

std::size_t CellGrid::sort(Particles& p, float outflow_x) {
    const std::size_t n = p.count;
    for_each_particle(n, [&](std::size_t i) {
        cell_of_[i] = p.x[i] > outflow_x ? static_cast<std::uint32_t>(cell_index(
                                               cell_along(0, p.x[i]), cell_along(1, p.y[i]), cell_along(2, p.z[i])))
                                         : no_cell;
    });
    std::fill(start_.begin(), start_.end(), 0U);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < n; ++i) {
        if (cell_of_[i] != no_cell) {
            ++start_[cell_of_[i]];
            ++kept;
        }
    }
    std::uint32_t sum = 0;
    for (std::uint32_t& s : start_) {
        sum += s;
        s = sum;  // the end of each cell; filling from the back turns it into the start
    }
    for (std::size_t i = n; i-- > 0;) {
        if (cell_of_[i] != no_cell) {
            source_[--start_[cell_of_[i]]] = static_cast<std::uint32_t>(i);
        }
    }
    for (auto array : {&Particles::x, &Particles::y, &Particles::z, &Particles::vx, &Particles::vy, &Particles::vz,
                       &Particles::shift_pressure, &Particles::pressure}) {
        gather(scratch_.*array, p.*array, source_, kept);
        std::swap(scratch_.*array, p.*array);
    }
    gather(scratch_.kind, p.kind, source_, kept);
    std::swap(scratch_.kind, p.kind);
    p.count = kept;
    return n - kept;
}

}  // namespace wade::fluid
